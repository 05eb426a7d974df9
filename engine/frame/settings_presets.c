// settings_presets.c: settings by a name.
// Data in: nothing. Data out: the table that --preset and the panel read. Called by: settings.c,
// shells, tools. Does not: say whether a level has global illumination; that is the level's
// (gi.enabled).
//
// Every preset names the same settings, so that one replaces another whole. Ambient occlusion darkens
// direct light as well, which real light does not do: `luz bench V8` shows that it takes pictures away
// from the path-traced ones. It stays where the published picture is meant.
#include "settings.h"

const SettingPreset setting_presets[] = {
    {"lavapipe",
     "gi.grid=64,gi.cascades=1,gi.format=half,gi.solid=off,gi.cosine=weighted,gi.faces=shared,"
     "gi.filter=directional,gi.bounces=2,gi.feedback=on,gi.diffuse=probes,gi.specular=off,"
     "gi.ao=on,gi.resolution=quarter,gi.dither=off,gi.mips=nearest,gi.share=4,gi.step_factor=0.5,"
     "gi.diffuse_aperture=60",
     "a CPU that draws"},
    {"balanced",
     "gi.grid=64,gi.cascades=1,gi.format=half,gi.solid=off,gi.cosine=weighted,gi.faces=apart,"
     "gi.filter=directional,gi.bounces=2,gi.feedback=off,gi.diffuse=cones,gi.specular=on,"
     "gi.ao=off,gi.resolution=half,gi.dither=on,gi.mips=linear,gi.share=1,gi.step_factor=0.5,"
     "gi.diffuse_aperture=60",
     "a small GPU"},
    {"high",
     "gi.grid=128,gi.cascades=1,gi.format=half,gi.solid=off,gi.cosine=weighted,gi.faces=apart,"
     "gi.filter=directional,gi.bounces=2,gi.feedback=on,gi.diffuse=cones,gi.specular=on,"
     "gi.ao=off,gi.resolution=half,gi.dither=on,gi.mips=linear,gi.share=1,gi.step_factor=0.5,"
     "gi.diffuse_aperture=60",
     "a large GPU"},
    {"thesis",
     "gi.grid=64,gi.cascades=1,gi.format=half,gi.solid=off,gi.cosine=weighted,gi.faces=shared,"
     "gi.filter=directional,gi.bounces=2,gi.feedback=off,gi.diffuse=cones,gi.specular=on,"
     "gi.ao=on,gi.resolution=full,gi.dither=off,gi.mips=linear,gi.share=1,gi.step_factor=0.5,"
     "gi.diffuse_aperture=60",
     "as published: cones at every pixel, one radiance a voxel"},
};
const u32 setting_preset_count = COUNT_OF(setting_presets);
