// debug_ui.cpp: the one C++ file of app/: Dear ImGui draws a small panel and all texts of the
// window.
//
// Data in: an App (measurements, settings, errors), texts. Data out: an Overlay; settings that the
// user changed. Called by: window.c. Does not: own settings; the controls are made from the list
// of settings (render_setting_descs), so a new setting appears here by itself.
//
// One small window: two large ones at 720p cost 6 ms on the software driver.
#include "debug_ui.h"
#include "overlay_build.h"
#include <backends/imgui_impl_glfw.h>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <imgui.h>

static_assert(sizeof(ImDrawVert) == sizeof(OverlayVertex), "vertices are copied as they are");
static_assert(sizeof(ImDrawIdx) == sizeof(u16), "indices are copied as they are");

// Pixel heights at which the built-in font is sharp: its grid is 13 pixels high.
static const f32 font_sizes[] = {13.0f, 26.0f, 39.0f};

struct DebugUi {
    ImGuiContext *context;
    ImFont *fonts[COUNT_OF(font_sizes)];
    OverlayBuild build;
};

DebugUi *debug_ui_create(GLFWwindow *window) {
    DebugUi *ui = new DebugUi();
    IMGUI_CHECKVERSION();
    ui->context = ImGui::CreateContext();
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = nullptr; // leaves no file behind
    io.LogFilename = nullptr;
    io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
    for (u32 i = 0; i < COUNT_OF(font_sizes); i++) {
        ImFontConfig config;
        config.SizePixels = font_sizes[i];
        config.OversampleH = config.OversampleV = 1;
        config.PixelSnapH = true;
        ui->fonts[i] = io.Fonts->AddFontDefault(&config);
    }
    ImGui::StyleColorsDark();
    ImGuiStyle &style = ImGui::GetStyle();
    style.WindowRounding = style.FrameRounding = 0.0f; // fewer triangles
    style.AntiAliasedLines = style.AntiAliasedFill = false;
    style.Colors[ImGuiCol_WindowBg].w = 0.82f;
    ImGui_ImplGlfw_InitForOther(window, true);
    return ui;
}

void debug_ui_destroy(DebugUi *ui) {
    if (!ui) return;
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext(ui->context);
    delete ui;
}

bool debug_ui_upload(DebugUi *ui, Renderer *renderer) {
    (void)ui;
    unsigned char *pixels;
    int width, height;
    ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    return renderer_set_overlay_texture(renderer, pixels, (u32)width, (u32)height);
}

bool debug_ui_wants_mouse(const DebugUi *ui) { return ui && ImGui::GetIO().WantCaptureMouse; }
bool debug_ui_wants_keyboard(const DebugUi *ui) { return ui && ImGui::GetIO().WantTextInput; }

// --- Texts ---

// A dark ground for a block of lines.
static void draw_box(ImDrawList *list, const PacketText2D *texts, u32 count) {
    const f32 margin = 6.0f;
    ImVec2 low(1e9f, 1e9f), high(0.0f, 0.0f);
    for (u32 i = 0; i < count; i++) {
        ImVec2 size = ImGui::CalcTextSize(texts[i].text);
        low = ImVec2(MIN(low.x, texts[i].x_px), MIN(low.y, texts[i].y_px));
        high = ImVec2(MAX(high.x, texts[i].x_px + size.x), MAX(high.y, texts[i].y_px + size.y));
    }
    if (count > 0)
        list->AddRectFilled(ImVec2(low.x - margin, low.y - margin),
                            ImVec2(high.x + margin, high.y + margin), IM_COL32(8, 10, 16, 190));
}

static void draw_texts(DebugUi *ui, App *app, u32 width_px, u32 height_px) {
    ImDrawList *list = ImGui::GetBackgroundDrawList();
    const PacketText2D *texts;
    u32 boxed, count = app_texts(app, width_px, height_px, &texts, &boxed);
    draw_box(list, texts, boxed);
    for (u32 i = 0; i < count; i++) {
        const PacketText2D *text = &texts[i];
        u32 font = 0;
        while (font + 1 < COUNT_OF(font_sizes) && font_sizes[font + 1] <= text->size_px) font++;
        f32 x = (f32)(i32)text->x_px, y = (f32)(i32)text->y_px, shift = (f32)(font + 1);
        // A dark copy behind it keeps it readable on bright pictures.
        u32 shadow = (text->color >> 24) * 3 / 4 << 24;
        list->AddText(ui->fonts[font], font_sizes[font], ImVec2(x + shift, y + shift), shadow,
                      text->text);
        list->AddText(ui->fonts[font], font_sizes[font], ImVec2(x, y), text->color, text->text);
    }
}

// --- Panel ---

static void panel_frame_times(const App *app) {
    ImGui::Text("%.1f fps  %.1f ms  %ux%u", (f64)app->fps, (f64)app->frame_ms[app->frame_index],
                app->internal_width_px, app->internal_height_px);
    f32 worst = 0.0f;
    for (f32 ms : app->frame_ms) worst = MAX(worst, ms);
    ImGui::PlotHistogram("##frames", app->frame_ms, APP_FRAMES_SHOWN, (int)app->frame_index + 1,
                         nullptr, 0.0f, MAX(worst, 34.0f),
                         ImVec2(ImGui::GetContentRegionAvail().x, 36.0f));
}

static void panel_passes(const App *app) {
    if (!ImGui::CollapsingHeader("passes (ms)", ImGuiTreeNodeFlags_DefaultOpen)) return;
    GpuTimer timers[GPU_TIMERS_CAP];
    u32 count = gpu_timers(app->gpu, timers, GPU_TIMERS_CAP);
    f32 sum = 0.0f;
    for (u32 i = 0; i < count; i++) {
        ImGui::Text("%6.2f %s", (f64)timers[i].ms, timers[i].name);
        sum += timers[i].ms;
    }
    ImGui::Text("%6.2f all", (f64)sum);
}

static void panel_cpu(const App *app) {
    if (!ImGui::CollapsingHeader("systems (ms)")) return;
    const SystemTable *systems = &app->session.systems;
    for (u32 i = 0; i < systems->count; i++)
        ImGui::Text("%6.2f %s", (f64)systems->ms[i], systems->rows[i].name);
    const PacketBuildTimes *times = &app->session.packet_times;
    ImGui::Text("%6.2f ticks of this frame", (f64)app->ticks_ms);
    ImGui::Text("%6.2f packet: cull %.2f lights %.2f", (f64)app->packet_ms, (f64)times->cull_ms,
                (f64)times->lights_ms);
    ImGui::Text("               grid %.2f pack %.2f", (f64)times->grid_ms, (f64)times->pack_ms);
    const f32 *stages = times->light_stage_ms;
    ImGui::Text("               cull %.2f hide %.2f+%.2f merge %.2f drop %.2f budget %.2f",
                (f64)stages[LIGHT_STAGE_FRUSTUM], (f64)times->occluders_ms,
                (f64)stages[LIGHT_STAGE_OCCLUSION], (f64)stages[LIGHT_STAGE_MERGE],
                (f64)stages[LIGHT_STAGE_DROP], (f64)stages[LIGHT_STAGE_BUDGET]);
}

static void panel_counts(const App *app) {
    if (!ImGui::CollapsingHeader("counts", ImGuiTreeNodeFlags_DefaultOpen)) return;
    const PacketCounts *counts = &app->counts;
    RendererStats stats = renderer_stats(app->renderer);
    ImGui::Text("lights    %u of %u, shaded %u", counts->lights_visible, counts->lights_total,
                counts->lights_shaded);
    ImGui::Text("meshes    %u of %u", counts->drawables_visible, counts->drawables_total);
    ImGui::Text("triangles %u", counts->triangles);
    ImGui::Text("draws     %u, barriers %u", stats.draw_calls, stats.barriers);
    ImGui::Text("lists     %u entries, longest %u, %u clusters, %u without room",
                stats.list_indices, stats.list_longest, stats.clusters, stats.list_fallbacks);
}

// Words separated by blanks become the zero-separated list that a combo wants.
static void words_to_items(const char *words, char *out, u64 out_cap) {
    u64 length = MIN(strlen(words), out_cap - 2);
    for (u64 i = 0; i < length; i++) out[i] = words[i] == ' ' ? '\0' : words[i];
    out[length] = out[length + 1] = '\0';
}

// One setting's control.
static void panel_setting(RenderSettings *settings, const SettingDesc *desc) {
    u8 *field = (u8 *)settings + desc->offset;
    bool has_effect = setting_has_effect(settings, desc);
    if (!has_effect) ImGui::BeginDisabled();
    switch (desc->type) {
    case SETTING_BOOL: {
        u32 value;
        memcpy(&value, field, sizeof value);
        bool on = value != 0;
        if (ImGui::Checkbox(desc->name, &on)) value = on;
        memcpy(field, &value, sizeof value);
        break;
    }
    case SETTING_ENUM: {
        char items[512];
        words_to_items(desc->words, items, sizeof items);
        ImGui::Combo(desc->name, (int *)field, items);
        break;
    }
    case SETTING_F32: {
        // Wide ranges need a finer hand near zero.
        ImGuiSliderFlags flags = desc->max > 100.0 ? ImGuiSliderFlags_Logarithmic : 0;
        f32 max = desc->max > 100.0 ? 100.0f : (f32)desc->max;
        ImGui::SliderFloat(desc->name, (f32 *)field, (f32)desc->min, max, "%.2f", flags);
        break;
    }
    case SETTING_U32:
        ImGui::InputInt(desc->name, (int *)field, 64, 256);
        break;
    }
    if (!has_effect) ImGui::EndDisabled();
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        ImGui::SetTooltip("%s%s", desc->help, has_effect ? "" : " (no effect with this path)");
}

// --- Settings that leave it to the level ---

// The level's column that a setting "gi.NAME" overrules, and its value as text; NULL = it overrules
// none. A level without the table has no global illumination: its values are the columns' own.
static const ColumnDesc *level_column(const World *world, const SettingDesc *desc, char *value,
                                      u64 value_cap) {
    if (desc->group != SETTING_GROUP_GI || strncmp(desc->name, "gi.", 3) != 0 || !world)
        return nullptr;
    const Table *table = world->tables[COMPONENT_gi];
    i32 index = table_find_column(table, desc->name + 3);
    if (index < 0) return nullptr;
    const ColumnDesc *column = &table->desc->columns[index];
    u32 word = (u32)column->initial;
    f32 number = (f32)column->initial;
    if (table->count > 0) {
        memcpy(&word, table_column(table, (u32)index), sizeof word);
        memcpy(&number, table_column(table, (u32)index), sizeof number);
    }
    switch (column->type) {
    case COLUMN_BOOL:
        snprintf(value, value_cap, "%s", word ? "on" : "off");
        if (strcmp(column->name, "enabled") == 0 && table->count == 0)
            snprintf(value, value_cap, "off");
        break;
    case COLUMN_ENUM: // the setting's words are the column's, after "level"
        settings_word(desc->name, word + 1, value, value_cap);
        break;
    case COLUMN_F32:
        snprintf(value, value_cap, "%g", (f64)number);
        break;
    default:
        snprintf(value, value_cap, "%u", word);
    }
    return column;
}

// A number: ticked = the setting's own, else the level's, which is shown.
static void panel_overruling_number(RenderSettings *settings, const SettingDesc *desc,
                                    const ColumnDesc *column, const char *level_value) {
    u8 *field = (u8 *)settings + desc->offset;
    bool is_float = desc->type == SETTING_F32;
    f32 number = is_float ? *(f32 *)field : (f32) * (u32 *)field;
    bool own = number > desc->initial;
    ImGui::PushID(desc->name);
    if (ImGui::Checkbox("##own", &own)) number = own ? (f32)atof(level_value) : (f32)desc->initial;
    // A whole number's 0 means the level's; 0 metres are metres.
    if (own && !is_float) number = MAX(number, 1.0f);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(104.0f);
    if (own) {
        f32 max = (f32)MIN(column->max, 1000.0), min = (f32)column->min;
        ImGuiSliderFlags flags = max > 10.0f ? ImGuiSliderFlags_Logarithmic : 0;
        ImGui::SliderFloat(desc->name, &number, min, max, is_float ? "%.2f" : "%.0f",
                           flags | ImGuiSliderFlags_AlwaysClamp);
    } else {
        ImGui::TextDisabled("%s (level)  %s", level_value, desc->name);
    }
    ImGui::PopID();
    if (is_float)
        *(f32 *)field = number;
    else
        *(u32 *)field = (u32)number;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", column->help);
}

// A word: the first is the level's, which is shown.
static void panel_overruling_word(RenderSettings *settings, const SettingDesc *desc,
                                  const ColumnDesc *column, const char *level_value) {
    u32 *field = (u32 *)((u8 *)settings + desc->offset);
    char words[512], word[48], shown[64];
    words_to_items(desc->words, words, sizeof words);
    snprintf(shown, sizeof shown, "%s (level)", level_value);
    bool has_effect = setting_has_effect(settings, desc);
    if (!has_effect) ImGui::BeginDisabled();
    if (*field != 0) settings_word(desc->name, *field, word, sizeof word);
    if (ImGui::BeginCombo(desc->name, *field == 0 ? shown : word)) {
        u32 index = 0;
        for (const char *item = words; *item; item += strlen(item) + 1, index++)
            if (ImGui::Selectable(index == 0 ? shown : item, *field == index)) *field = index;
        ImGui::EndCombo();
    }
    if (!has_effect) ImGui::EndDisabled();
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        ImGui::SetTooltip("%s", column->help);
}

static void panel_setting_or_level(const World *world, RenderSettings *settings,
                                   const SettingDesc *desc) {
    char value[48];
    const ColumnDesc *column = level_column(world, desc, value, sizeof value);
    if (!column) {
        panel_setting(settings, desc);
    } else if (desc->type == SETTING_F32 || desc->type == SETTING_U32) {
        panel_overruling_number(settings, desc, column, value);
    } else {
        panel_overruling_word(settings, desc, column, value);
    }
}

// All settings, by group; the first group is open.
static void panel_setting_groups(const World *world, RenderSettings *settings, bool has_size) {
    ImGui::PushItemWidth(130.0f);
    for (u32 group = 0; group < SETTING_GROUP_COUNT; group++) {
        if (!ImGui::TreeNodeEx(setting_group_titles[group],
                               group == 0 ? ImGuiTreeNodeFlags_DefaultOpen : 0))
            continue;
        for (u32 i = 0; i < render_setting_count; i++) {
            const SettingDesc *desc = &render_setting_descs[i];
            bool is_size = desc->offset == offsetof(RenderSettings, scale) ||
                           desc->offset == offsetof(RenderSettings, target_ms);
            if ((u32)desc->group == group && (has_size || !is_size))
                panel_setting_or_level(world, settings, desc);
        }
        ImGui::TreePop();
    }
    ImGui::PopItemWidth();
    settings_clamp(settings);
}

static void panel_settings(App *app) {
    if (!ImGui::CollapsingHeader("settings", ImGuiTreeNodeFlags_DefaultOpen)) return;
    ImGui::PushID("settings");
    panel_setting_groups(app->session.world, &app->settings, true);
    ImGui::PopID();
}

// The second way: what it is, where the line is, its own settings.
static void panel_split(App *app) {
    if (!ImGui::CollapsingHeader("split")) return;
    ImGui::PushID("split");
    ImGui::Checkbox("two ways (X)", &app->split);
    ImGui::PushItemWidth(130.0f);
    char items[128];
    words_to_items(SPLIT_MODE_WORDS, items, sizeof items);
    ImGui::Combo("shown", (int *)&app->split_view.mode, items);
    ImGui::SliderFloat("line", &app->split_view.at, 0.0f, 1.0f, "%.2f");
    f32 gain = app->split_view.gain > 0.0f ? app->split_view.gain : SPLIT_GAIN;
    if (ImGui::SliderFloat("gain", &gain, 1.0f, 255.0f, "%.0f", ImGuiSliderFlags_Logarithmic))
        app->split_view.gain = gain;
    ImGui::PopItemWidth();
    if (ImGui::Button("B like A")) app->other_settings = app->settings;
    ImGui::SameLine();
    if (ImGui::Button("exchange")) {
        RenderSettings kept = app->settings;
        app->settings = app->other_settings;
        app->settings.scale = kept.scale;
        app->settings.target_ms = kept.target_ms;
        app->other_settings = kept;
    }
    ImGui::TextUnformatted("settings of B:");
    panel_setting_groups(app->session.world, &app->other_settings, false);
    ImGui::PopID();
}

// --- The level's own rows ---

static bool column_control(const ColumnDesc *column, void *value) {
    switch (column->type) {
    case COLUMN_F32: {
        ImGuiSliderFlags flags = column->max > 10.0 ? ImGuiSliderFlags_Logarithmic : 0;
        f32 max = (f32)MIN(column->max, 1000.0), min = (f32)MAX(column->min, -1000.0);
        return ImGui::SliderFloat(column->name, (f32 *)value, min, max,
                                  column->max > 1.0 ? "%.2f" : "%.4f",
                                  flags | ImGuiSliderFlags_AlwaysClamp);
    }
    case COLUMN_U32:
    case COLUMN_I32: {
        int number = *(int *)value;
        if (!ImGui::InputInt(column->name, &number)) return false;
        f64 clamped = CLAMP((f64)number, column->min, column->max);
        *(int *)value = (int)clamped;
        return true;
    }
    case COLUMN_BOOL: {
        bool on = *(u32 *)value != 0;
        bool changed = ImGui::Checkbox(column->name, &on);
        *(u32 *)value = on;
        return changed;
    }
    case COLUMN_ENUM: {
        char items[512];
        words_to_items(column->unit, items, sizeof items);
        return ImGui::Combo(column->name, (int *)value, items);
    }
    default:
        return false;
    }
}

// Controls of one row's columns that level text can set. They act at once; the level's file stays.
static void panel_row(Table *table, u32 row) {
    bool changed = false;
    ImGui::PushItemWidth(130.0f);
    for (u32 i = 0; i < table->desc->column_count; i++) {
        const ColumnDesc *column = &table->desc->columns[i];
        if (!column->key[0]) continue;
        changed |= column_control(column, (u32 *)table_columns(table)[i] + row);
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("%s%s%s", column->help, column->type == COLUMN_ENUM ? "" : ", ",
                              column->type == COLUMN_ENUM ? "" : column->unit);
    }
    ImGui::PopItemWidth();
    if (changed) table_touch(table, row);
}

// A recording or replay must see the level as it is in its file.
static bool can_edit(const App *app) {
    return app->session.world && !app->writer && !app->has_replay;
}

static void panel_manager(App *app) {
    if (!ImGui::CollapsingHeader("light manager")) return;
    const PacketCounts *c = &app->counts;
    u32 outside = c->lights_total - MIN(c->lights_visible + c->lights_occluded, c->lights_total);
    ImGui::Text("%6u lights of the level", c->lights_total);
    ImGui::Text("%6u - outside the view", outside);
    ImGui::Text("%6u - occluded", c->lights_occluded);
    ImGui::Text("%6u - merged pairs, error %.4f", c->lights_merged_pairs, (f64)c->merge_error);
    ImGui::Text("%6u - too small or faint", c->lights_dropped);
    ImGui::Text("%6u - over the budget", c->lights_over_budget);
    ImGui::Text("%6u shaded, %u of them fading", c->lights_shaded, c->lights_fading);
    ImGui::Text("%6u near, %u between, %u far", c->lights_near, c->lights_between, c->lights_far);
    ImGui::Text("%6u occluders, %u drawables behind", c->occluders, c->drawables_occluded);
    const PacketBuildTimes *times = &app->session.packet_times;
    ImGui::Text("%6.2f ms lights, %.2f ms lists", (f64)times->lights_ms, (f64)times->grid_ms);
    static const char *const stages[] = {"candidates", "frustum", "occlusion", "merge",
                                         "drop",       "budget",  "individual"};
    static_assert(COUNT_OF(stages) == LIGHT_STAGE_COUNT, "a name for each stage");
    for (u32 i = 0; i < LIGHT_STAGE_COUNT; i++)
        ImGui::Text("   %.3f %s", (f64)times->light_stage_ms[i], stages[i]);
    if (!can_edit(app)) return;
    Table *table = app->session.world->tables[COMPONENT_light_manager];
    ImGui::PushID("manager");
    if (table->count > 0)
        panel_row(table, 0);
    else if (ImGui::Button("change its numbers"))
        world_singleton(app->session.world, COMPONENT_light_manager);
    ImGui::PopID();
}

// What each step of global illumination costs, and what there is of it.
static void panel_gi(App *app) {
    RendererStats stats = renderer_stats(app->renderer);
    if (stats.gi_bytes == 0 || !ImGui::CollapsingHeader("global illumination")) return;
    GpuTimer timers[GPU_TIMERS_CAP];
    u32 count = gpu_timers(app->gpu, timers, GPU_TIMERS_CAP);
    f32 sum = 0.0f;
    for (u32 i = 0; i < count; i++) {
        const char *name = timers[i].name;
        if (strncmp(name, "voxel", 5) != 0 && strncmp(name, "gi ", 3) != 0 &&
            strncmp(name, "probes", 6) != 0)
            continue;
        ImGui::Text("%6.2f ms %s", (f64)timers[i].ms, name);
        sum += timers[i].ms;
    }
    ImGui::Text("%6.2f ms all", (f64)sum);
    ImGui::Text("%6.1f MiB on the device", (f64)stats.gi_bytes / (1024.0 * 1024.0));
    ImGui::Text("%6u voxels, %u of them dynamic", stats.gi_voxels, stats.gi_dynamic_voxels);
    if (stats.gi_lost_voxels) ImGui::Text("%6u found no room", stats.gi_lost_voxels);
    ImGui::Text("%6u lights, %u in their lists", app->counts.gi_lights,
                app->counts.gi_light_indices);
    ImGui::Text("voxelised %u times, dynamic ones %u", stats.gi_static_voxelised,
                stats.gi_dynamic_voxelised);
    ImGui::Text("lit %u times, probes traced %u", stats.gi_relit, stats.gi_probes_traced);
    ImGui::TextUnformatted("presets:");
    for (u32 i = 0; i < setting_preset_count; i++) {
        if (i % 2) ImGui::SameLine();
        if (ImGui::SmallButton(setting_presets[i].name))
            settings_set_preset(&app->settings, setting_presets[i].name);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", setting_presets[i].help);
    }
    if (!can_edit(app)) return;
    Table *table = app->session.world->tables[COMPONENT_gi];
    if (table->count == 0 || !ImGui::TreeNode("the level's values")) return;
    panel_row(table, 0);
    ImGui::TreePop();
}

static void panel_post(App *app) {
    if (!can_edit(app)) return;
    Table *table = app->session.world->tables[COMPONENT_post];
    if (table->count == 0 || !ImGui::CollapsingHeader("post chain")) return;
    for (u32 row = 0; row < table->count; row++) {
        const char *name = world_name(app->session.world, table->entity[row]);
        char title[96];
        snprintf(title, sizeof title, "%s###post%u", name[0] ? name : "step", row);
        if (!ImGui::TreeNode(title)) continue;
        panel_row(table, row);
        ImGui::TreePop();
    }
}

static void panel_level(App *app) {
    const char *names[APP_CAMERAS_CAP];
    u32 count = app_cameras(app, names, APP_CAMERAS_CAP);
    ImGui::PushItemWidth(130.0f);
    if (ImGui::BeginCombo("camera", app->camera[0] ? app->camera : "your eyes")) {
        if (ImGui::Selectable("your eyes", !app->camera[0])) app_set_camera(app, nullptr);
        for (u32 i = 0; i < count; i++)
            if (ImGui::Selectable(names[i], strcmp(names[i], app->camera) == 0))
                app_set_camera(app, names[i]);
        ImGui::EndCombo();
    }
    ImGui::PopItemWidth();
    if (ImGui::Button("restart level")) app->want_restart = true;
    ImGui::SameLine();
    ImGui::Checkbox("pause", &app->paused);
    if (app->level_error[0] || app->shader_error[0]) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1.0f, 0.4f, 0.4f, 1.0f));
        ImGui::TextWrapped("%s%s", app->level_error, app->shader_error);
        ImGui::PopStyleColor();
    }
}

static void draw_panel(App *app, u32 width_px) {
    ImGui::SetNextWindowPos(ImVec2((f32)width_px - 298.0f, 8.0f), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize(ImVec2(290.0f, 0.0f), ImGuiCond_FirstUseEver);
    if (ImGui::Begin("luz", &app->panel, ImGuiWindowFlags_NoFocusOnAppearing)) {
        ImGui::TextUnformatted(gpu_info(app->gpu)->device_name);
        panel_frame_times(app);
        panel_level(app);
        panel_passes(app);
        panel_cpu(app);
        panel_counts(app);
        panel_settings(app);
        panel_split(app);
        panel_manager(app);
        panel_gi(app);
        panel_post(app);
    }
    ImGui::End();
}

// --- Frame ---

static const Overlay *build_overlay(DebugUi *ui, u32 width_px, u32 height_px) {
    const ImDrawData *data = ImGui::GetDrawData();
    // Framebuffer pixels of one window unit: 1, except on some high-density screens.
    f32 scale = data->FramebufferScale.x;
    overlay_build_begin(&ui->build, width_px, height_px);
    for (int i = 0; i < data->CmdListsCount; i++) {
        const ImDrawList *list = data->CmdLists[i];
        if (!overlay_build_list(&ui->build, (const OverlayVertex *)list->VtxBuffer.Data,
                                (u32)list->VtxBuffer.Size, list->IdxBuffer.Data,
                                (u32)list->IdxBuffer.Size, scale))
            break;
        for (const ImDrawCmd &command : list->CmdBuffer) {
            if (command.UserCallback) continue;
            const f32 clip[4] = {command.ClipRect.x * scale, command.ClipRect.y * scale,
                                 command.ClipRect.z * scale, command.ClipRect.w * scale};
            overlay_build_command(&ui->build, clip, command.VtxOffset, command.IdxOffset,
                                  command.ElemCount);
        }
    }
    return overlay_build_end(&ui->build);
}

const Overlay *debug_ui_frame(DebugUi *ui, App *app, u32 width_px, u32 height_px, bool pointer) {
    ImGuiIO &io = ImGui::GetIO();
    if (pointer)
        io.ConfigFlags &= ~ImGuiConfigFlags_NoMouse;
    else
        io.ConfigFlags |= ImGuiConfigFlags_NoMouse;
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    draw_texts(ui, app, width_px, height_px);
    if (app->panel) draw_panel(app, width_px);
    ImGui::Render();
    return build_overlay(ui, width_px, height_px);
}
