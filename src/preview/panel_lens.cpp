// Focus, the opening and the angle of view.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include <imgui.h>

#include "preview/panels.h"
#include "preview/setting_controls.h"

namespace matchlight {

namespace {

struct Resolution {
    std::string_view name;
    std::int64_t width, height;
};

/// Those of the studies; any other by width and height below.
void lay_out_resolution(Session& session, Controls& controls, const CameraSettings& camera) {
    static constexpr std::array<Resolution, 3> usual{
        {{"512×512", 512, 512}, {"1024×512", 1024, 512}, {"1024×1024", 1024, 1024}}};
    static constexpr std::array<std::string_view, 4> names{"as given", usual[0].name, usual[1].name, usual[2].name};
    const auto is_now = [&](const Resolution& one) { return one.width == camera.width && one.height == camera.height; };
    const auto found = std::ranges::find_if(usual, is_now);
    std::size_t chosen = found == usual.end() ? 0 : static_cast<std::size_t>(found - usual.begin()) + 1;
    if (!controls.choice("camera.resolution", "resolution", chosen, names, "of the picture") || chosen == 0) return;
    const Resolution& wanted = usual[chosen - 1];
    session.change(
        [&](SceneText& text) {
            text.set("camera.width", wanted.width);
            text.set("camera.height", wanted.height);
        },
        "set the resolution");
}

}  // namespace

void lay_out_lens_panel(Session& session, Controls& controls) {
    lay_out_effect(session, controls, *find_setting("effects", "depth_of_field"));
    ImGui::TextWrapped("Click in the picture with shift held down to focus there.");
    if (!session.scene().camera) return;
    ImGui::Spacing();
    ImGui::TextUnformatted("Camera");
    lay_out_resolution(session, controls, *session.scene().camera);
    if (!session.scene().camera) return;
    static constexpr std::array<std::string_view, 3> left_out{"keys", "frames", "fps"};
    lay_out_section(session, controls, "camera", "camera", left_out);
}

}  // namespace matchlight
