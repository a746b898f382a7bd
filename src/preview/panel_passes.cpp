// What became of each pass of the frame, and what frames cost.
#include <algorithm>

#include <fmt/format.h>
#include <imgui.h>

#include "preview/panels.h"

namespace matchlight {

namespace {

void cell(const std::string& text) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(text.c_str());
}

/// It was drawn before, and what it left is still there.
bool is_kept(const PassReport& pass) {
    return pass.why.starts_with("made once");
}

/// For scripts: no spaces.
std::string control_of(const PassReport& pass) {
    std::string name = "passes." + pass.name;
    std::ranges::replace(name, ' ', '_');
    return name;
}

void lay_out_pass(Session& session, Controls& controls, const PassReport& pass) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const bool watched = session.watched_pass() == pass.name;
    if (controls.row(control_of(pass), pass.name.c_str(), watched)) session.watch(watched ? "" : pass.name);
    if (ImGui::IsItemHovered()) {
        const Region& region = pass.frame_pixels;
        ImGui::SetTooltip("%s", fmt::format("{}\n{}×{} at {}, {}\n{:.2f} MB, {:.1f} times its bandwidth bound\n{}",
                                            pass.name, region.width, region.height, region.x, region.y,
                                            pass.bytes / 1e6, pass.bandwidth_bounds, pass.why)
                                    .c_str());
    }
    cell(is_kept(pass) ? "once" : fmt::format("{:.2f}", pass.ms));
    cell(fmt::format("{}×{}", pass.frame_pixels.width, pass.frame_pixels.height));
    cell(fmt::format("{:.1f}", pass.bytes / 1e6));
}

void lay_out_drawn(Session& session, Controls& controls, const std::vector<PassReport>& passes) {
    if (!ImGui::BeginTable("passes", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) return;
    ImGui::TableSetupColumn("pass", ImGuiTableColumnFlags_WidthStretch);
    for (const char* column : {"ms", "pixels", "MB"}) ImGui::TableSetupColumn(column);
    ImGui::TableHeadersRow();
    for (const PassReport& pass : passes) {
        if (pass.drawn || is_kept(pass)) lay_out_pass(session, controls, pass);
    }
    ImGui::EndTable();
}

void lay_out_times(const Session& session) {
    const std::vector<float>& times_ms = session.picture_times_ms();
    if (times_ms.empty()) return;
    const float most = *std::ranges::max_element(times_ms);
    const std::string text = fmt::format("{:.0f} ms, at most {:.0f}", times_ms.back(), most);
    const float height = 3 * ImGui::GetTextLineHeight();
    ImGui::PlotLines("##times", times_ms.data(), static_cast<int>(times_ms.size()), 0, text.c_str(), 0, most,
                     {ImGui::GetContentRegionAvail().x, height});
}

}  // namespace

void lay_out_passes_panel(Session& session, Controls& controls) {
    if (controls.button("passes.measure", "Measure this frame", "time every pass of it, and print them (e)")) {
        session.ask_for_passes();
    }
    const bool measured = session.picture() && !session.picture()->passes.empty();
    if (measured) {
        ImGui::SameLine();
        if (controls.button("passes.write", "Write", "them to a text file beside the scene")) session.write_passes();
    }
    lay_out_times(session);
    if (!measured) return;
    ImGui::TextWrapped("Click a pass to see what it leaves, and again to see the picture.");
    const std::vector<PassReport> passes = session.picture()->passes;
    lay_out_drawn(session, controls, passes);
    ImGui::Spacing();
    ImGui::TextUnformatted("Left out:");
    for (const PassReport& pass : passes) {
        if (!pass.drawn && !is_kept(pass)) ImGui::TextWrapped("%s: %s", pass.name.c_str(), pass.why.c_str());
    }
}

}  // namespace matchlight
