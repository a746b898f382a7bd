// Dark, with the desktop's own sans-serif where there is one, at the size of the screen's scale.
#include "preview/gui.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

namespace matchlight {

namespace {

constexpr float font_px = 15;  // at scale 1

/// ImGui asks for these keys itself, in text fields and lists.
constexpr std::array<std::pair<ImGuiKey, int>, 21> gui_keys{{{ImGuiKey_Tab, GLFW_KEY_TAB},
                                                             {ImGuiKey_LeftArrow, GLFW_KEY_LEFT},
                                                             {ImGuiKey_RightArrow, GLFW_KEY_RIGHT},
                                                             {ImGuiKey_UpArrow, GLFW_KEY_UP},
                                                             {ImGuiKey_DownArrow, GLFW_KEY_DOWN},
                                                             {ImGuiKey_PageUp, GLFW_KEY_PAGE_UP},
                                                             {ImGuiKey_PageDown, GLFW_KEY_PAGE_DOWN},
                                                             {ImGuiKey_Home, GLFW_KEY_HOME},
                                                             {ImGuiKey_End, GLFW_KEY_END},
                                                             {ImGuiKey_Delete, GLFW_KEY_DELETE},
                                                             {ImGuiKey_Backspace, GLFW_KEY_BACKSPACE},
                                                             {ImGuiKey_Space, GLFW_KEY_SPACE},
                                                             {ImGuiKey_Enter, GLFW_KEY_ENTER},
                                                             {ImGuiKey_Escape, GLFW_KEY_ESCAPE},
                                                             {ImGuiKey_KeyPadEnter, GLFW_KEY_KP_ENTER},
                                                             {ImGuiKey_A, GLFW_KEY_A},
                                                             {ImGuiKey_C, GLFW_KEY_C},
                                                             {ImGuiKey_V, GLFW_KEY_V},
                                                             {ImGuiKey_X, GLFW_KEY_X},
                                                             {ImGuiKey_Y, GLFW_KEY_Y},
                                                             {ImGuiKey_Z, GLFW_KEY_Z}}};

}  // namespace

Gui::Gui(float scale) : scale_(scale), context_(ImGui::CreateContext()) {
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // what is remembered is remembered by window_settings.h
    io.LogFilename = nullptr;
    io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
    for (const auto& [key, of_glfw] : gui_keys) io.KeyMap[key] = of_glfw;
    load_font();
    set_look();
    renderer_.make_glyphs();
}

Gui::~Gui() {
    ImGui::DestroyContext(context_);
}

void Gui::load_font() {
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    static constexpr std::array<ImWchar, 7> glyphs{0x20, 0xff, 0x370, 0x3ff, 0x2010, 0x2044, 0};
    for (const char* file : {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                             "/usr/share/fonts/dejavu/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf"}) {
        if (!std::filesystem::exists(file)) continue;
        if (fonts.AddFontFromFileTTF(file, font_px * scale_, nullptr, glyphs.data()) != nullptr) return;
    }
    ImFontConfig built_in;
    built_in.SizePixels = 13 * scale_;  // what it was drawn for
    fonts.AddFontDefault(&built_in);
}

void Gui::set_look() {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 0;
    style.WindowBorderSize = 0;
    style.FrameRounding = 3;
    style.GrabRounding = 3;
    style.WindowPadding = {8, 8};
    style.ItemSpacing = {7, 5};
    style.ScrollbarSize = 12;
    style.Colors[ImGuiCol_WindowBg] = {0.11f, 0.11f, 0.12f, 1};
    style.Colors[ImGuiCol_PopupBg] = {0.14f, 0.14f, 0.15f, 1};
    style.Colors[ImGuiCol_FrameBg] = {0.20f, 0.21f, 0.23f, 1};
    style.Colors[ImGuiCol_Button] = {0.24f, 0.26f, 0.30f, 1};
    style.ScaleAllSizes(scale_);
}

void Gui::feed(const InputEvent& event) {
    ImGuiIO& io = ImGui::GetIO();
    switch (event.kind) {
        case InputEvent::Kind::pointer:
            io.MousePos = {static_cast<float>(event.value.x()), static_cast<float>(event.value.y())};
            break;
        case InputEvent::Kind::button:
            if (event.code >= 0 && event.code < ImGuiMouseButton_COUNT) io.MouseDown[event.code] = event.down;
            break;
        case InputEvent::Kind::scroll:
            io.MouseWheelH += static_cast<float>(event.value.x());
            io.MouseWheel += static_cast<float>(event.value.y());
            break;
        case InputEvent::Kind::key:
            if (event.code >= 0 && event.code < IM_ARRAYSIZE(io.KeysDown)) io.KeysDown[event.code] = event.down;
            break;
        case InputEvent::Kind::text:
            io.AddInputCharactersUTF8(event.text.c_str());
            break;
        case InputEvent::Kind::drop:
        case InputEvent::Kind::close:
            return;
    }
    if (event.kind == InputEvent::Kind::key || event.kind == InputEvent::Kind::button) {
        io.KeyCtrl = event.control;
        io.KeyShift = event.shift;
        io.KeyAlt = event.alt;
    }
}

void Gui::begin(const Eigen::Vector2i& size_px, double seconds) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(size_px.x()), static_cast<float>(size_px.y())};
    io.DeltaTime = static_cast<float>(std::max(1e-4, seconds));
    ImGui::NewFrame();
}

std::vector<Region> Gui::end() {
    ImGui::Render();
    const ImVec2& size = ImGui::GetIO().DisplaySize;
    return damage_.since_last(*ImGui::GetDrawData(),
                              {0, 0, static_cast<int>(std::lround(size.x)), static_cast<int>(std::lround(size.y))});
}

void Gui::draw(const Framebuffer& target, const Region& part) {
    renderer_.draw(*ImGui::GetDrawData(), target, part);
}

Eigen::Vector2d Gui::pointer_px() const {
    const ImVec2& place = ImGui::GetIO().MousePos;
    return {place.x, place.y};
}

bool Gui::wants_text() const {
    return ImGui::GetIO().WantTextInput;
}

}  // namespace matchlight
