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
    ImGui::Text("fullest tile %u lights", counts->cell_light_max);
}

// Words separated by blanks become the zero-separated list that a combo wants.
static void words_to_items(const char *words, char *out, u64 out_cap) {
    u64 length = MIN(strlen(words), out_cap - 2);
    for (u64 i = 0; i < length; i++) out[i] = words[i] == ' ' ? '\0' : words[i];
    out[length] = out[length + 1] = '\0';
}

static void panel_settings(App *app) {
    if (!ImGui::CollapsingHeader("settings", ImGuiTreeNodeFlags_DefaultOpen)) return;
    ImGui::PushItemWidth(130.0f);
    for (u32 i = 0; i < render_setting_count; i++) {
        const SettingDesc *desc = &render_setting_descs[i];
        u8 *field = (u8 *)&app->settings + desc->offset;
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
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", desc->help);
    }
    ImGui::PopItemWidth();
    settings_clamp(&app->settings);
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
