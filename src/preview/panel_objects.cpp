// What is virtual in the picture.
#include <array>
#include <string_view>

#include <fmt/format.h>
#include <imgui.h>

#include "preview/panels.h"
#include "preview/setting_controls.h"

namespace matchlight {

namespace {

constexpr double new_shape_scale = 0.05;  // metres: of a size with what stands on a table

void lay_out_list(Session& session, Controls& controls) {
    const std::vector<ObjectSettings>& objects = session.scene().objects;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        bool chosen = session.chosen() == i;
        const std::string text = fmt::format("{}  {}", i, objects[i].name);
        if (controls.row(fmt::format("object[{}]", i), text.c_str(), chosen)) session.choose(i);
    }
}

void lay_out_additions(Session& session, Controls& controls) {
    static constexpr std::array<std::string_view, 8> shapes{"add a shape", "sphere",   "box",  "plane",
                                                            "torus",       "cylinder", "cone", "teapot"};
    std::size_t shape = 0;
    if (controls.choice("add", "", shape, shapes, "models and sphere sets: drop their files onto the window") &&
        shape > 0) {
        session.add_object({{"shape", std::string(shapes[shape])},
                            {"translate", std::vector<double>{0, 0, new_shape_scale / 2}},
                            {"scale", new_shape_scale}});
    }
    if (!session.chosen()) return;
    ImGui::SameLine();
    if (controls.button("remove", "Remove", "the chosen object, from the scene")) session.remove_chosen();
}

}  // namespace

void lay_out_objects_panel(Session& session, Controls& controls) {
    lay_out_list(session, controls);
    lay_out_additions(session, controls);
    if (!session.chosen()) return;
    const std::string key = fmt::format("object[{}]", *session.chosen());
    ImGui::Separator();
    // Which file it comes from and how it moves are said once, and not by sliders.
    static constexpr std::array<std::string_view, 6> left_out{"model", "shape", "spheres", "sphere", "spin", "keys"};
    lay_out_section(session, controls, "object", key, left_out);
}

}  // namespace matchlight
