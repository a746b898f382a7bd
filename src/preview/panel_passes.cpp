// What became of each pass of the frame, and what frames cost.
#include <fmt/format.h>
#include <imgui.h>

#include "preview/panels.h"

namespace matchlight {

namespace {

void cell(const std::string& text) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(text.c_str());
}

void lay_out_pass(const PassReport& pass) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(pass.name.c_str());
    if (ImGui::IsItemHovered()) {
        const Region& region = pass.frame_pixels;
        ImGui::SetTooltip("%s", fmt::format("{}\n{}×{} at {}, {}\n{:.2f} MB, {:.1f} times its bandwidth bound\n{}",
                                            pass.name, region.width, region.height, region.x, region.y,
                                            pass.bytes / 1e6, pass.bandwidth_bounds, pass.why)
                                    .c_str());
    }
    cell(fmt::format("{:.2f}", pass.ms));
    cell(fmt::format("{}×{}", pass.frame_pixels.width, pass.frame_pixels.height));
    cell(fmt::format("{:.1f}", pass.bytes / 1e6));
}

void lay_out_drawn(const std::vector<PassReport>& passes) {
    if (!ImGui::BeginTable("passes", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) return;
    ImGui::TableSetupColumn("pass", ImGuiTableColumnFlags_WidthStretch);
    for (const char* column : {"ms", "pixels", "MB"}) ImGui::TableSetupColumn(column);
    ImGui::TableHeadersRow();
    for (const PassReport& pass : passes) {
        if (pass.drawn) lay_out_pass(pass);
    }
    ImGui::EndTable();
}

}  // namespace

void lay_out_passes_panel(Session& session, Controls& controls) {
    if (controls.button("passes.measure", "Measure this frame", "time every pass of it, and print them (e)")) {
        session.ask_for_passes();
    }
    if (!session.picture() || session.picture()->passes.empty()) return;
    const std::vector<PassReport>& passes = session.picture()->passes;
    lay_out_drawn(passes);
    ImGui::Spacing();
    ImGui::TextUnformatted("Left out:");
    for (const PassReport& pass : passes) {
        if (!pass.drawn) ImGui::TextWrapped("%s: %s", pass.name.c_str(), pass.why.c_str());
    }
}

}  // namespace matchlight
