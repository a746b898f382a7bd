// Thin covers of ImGui's widgets.
#include "preview/controls.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "core/error.h"

namespace matchlight {

namespace {

Region region_of(const ImVec2& from, const ImVec2& to) {
    const auto whole = [](float value) { return static_cast<int>(std::lround(value)); };
    return {whole(from.x), whole(from.y), whole(to.x - from.x), whole(to.y - from.y)};
}

/// What stands after ## tells one control from another and is not shown.
std::string labelled(const char* text, const std::string& name) {
    return fmt::format("{}##{}", text, name);
}

[[noreturn]] void refuse(const std::string& name, const std::string& value, const std::string& wanted) {
    throw InputError({}, fmt::format("'{}' cannot be set to '{}': {}", name, value, wanted));
}

template <class Number>
void read_three(const std::string& name, const std::string& text, Number (&three)[3]) {
    const char* at = text.data();
    const char* const end = at + text.size();
    for (Number& number : three) {
        while (at != end && (*at == ' ' || *at == ',')) ++at;
        const auto read = std::from_chars(at, end, number);
        if (read.ec != std::errc()) refuse(name, text, "three numbers");
        at = read.ptr;
    }
}

/// A hundred pixels change a value by about itself.
float drag_speed(double value, const NumberControl& range) {
    constexpr double share = 0.01, least = 0.001;
    return static_cast<float>(std::max(range.whole ? 0.1 : least, share * std::abs(value)));
}

}  // namespace

std::optional<bool> switch_word(std::string_view word) {
    if (word == "on" || word == "yes" || word == "true") return true;
    if (word == "off" || word == "no" || word == "false") return false;
    return std::nullopt;
}

std::optional<double> number_word(std::string_view text) {
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

void Controls::begin_frame() {
    std::swap(before_, laid_out_);
    laid_out_.clear();
    held_ = false;
}

void Controls::set(const std::string& name, const std::string& value) {
    set_ = SetValue{name, value};
}

std::optional<std::string> Controls::set_for(const std::string& name) {
    if (!set_ || set_->name != name) return std::nullopt;
    std::string value = std::move(set_->value);
    set_.reset();
    return value;
}

std::optional<std::string> Controls::take_unfound() {
    if (!set_) return std::nullopt;
    std::string name = std::move(set_->name);
    set_.reset();
    return name;
}

const LaidOutControl* Controls::find(const std::string& name) const {
    for (const auto* list : {&laid_out_, &before_}) {
        const auto found = std::ranges::find(*list, name, &LaidOutControl::name);
        if (found != list->end()) return &*found;
    }
    return nullptr;
}

void Controls::note(const std::string& name, const char* text, const char* tooltip) {
    const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
    const ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 clip_from = list->GetClipRectMin(), clip_to = list->GetClipRectMax();
    const Region place = region_of(from, to);
    laid_out_.push_back({.name = name,
                         .place = place,
                         .seen = place.intersected(region_of(clip_from, clip_to)),
                         .clipped_text = ImGui::CalcTextSize(text, nullptr, true).x > to.x - from.x + 1});
    held_ = held_ || ImGui::IsItemActive();
    if (tooltip != nullptr && *tooltip != '\0' && ImGui::IsItemHovered()) {
        ImGui::BeginTooltip();
        ImGui::PushTextWrapPos(ImGui::GetFontSize() * 24);
        ImGui::TextUnformatted(tooltip);
        ImGui::PopTextWrapPos();
        ImGui::EndTooltip();
    }
}

bool Controls::switched(const std::string& name, bool& on) {
    const auto value = set_for(name);
    if (!value) return false;
    const auto word = switch_word(*value);
    if (!word) refuse(name, *value, "on or off");
    return std::exchange(on, *word) != *word;
}

bool Controls::button(const std::string& name, const char* text, const char* tooltip) {
    const bool pressed = ImGui::Button(labelled(text, name).c_str());
    note(name, text, tooltip);
    return set_for(name).has_value() || pressed;
}

bool Controls::area(const std::string& name, float side) {
    const bool pressed = ImGui::InvisibleButton(name.c_str(), {side, side});
    note(name, "", nullptr);
    return pressed;
}

bool Controls::toggle(const std::string& name, const char* text, bool& on, const char* tooltip) {
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    const bool was_on = on;
    const bool changed = ImGui::Button(labelled(text, name).c_str());
    if (was_on) ImGui::PopStyleColor();
    if (changed) on = !on;
    note(name, text, tooltip);
    return switched(name, on) || changed;
}

bool Controls::row(const std::string& name, const char* text, bool chosen) {
    // It would reach half the spacing into its neighbours.
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
    const bool pressed = ImGui::Selectable(labelled(text, name).c_str(), chosen);
    ImGui::PopStyleVar();
    note(name, text, nullptr);
    return set_for(name).has_value() || pressed;
}

bool Controls::checkbox(const std::string& name, const char* text, bool& on, const char* tooltip) {
    const bool changed = ImGui::Checkbox(labelled(text, name).c_str(), &on);
    note(name, text, tooltip);
    return switched(name, on) || changed;
}

bool Controls::number(const std::string& name, const char* text, double& value, const NumberControl& range,
                      const char* tooltip) {
    const std::string label = labelled(text, name);
    const char* format = range.whole ? "%.0f" : "%.4g";
    const ImGuiSliderFlags flags =
        ImGuiSliderFlags_AlwaysClamp | (range.logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    bool changed = false;
    if (range.slides) {
        changed = ImGui::SliderScalar(label.c_str(), ImGuiDataType_Double, &value, &range.lowest, &range.highest,
                                      format, flags);
    } else {
        changed = ImGui::DragScalar(label.c_str(), ImGuiDataType_Double, &value, drag_speed(value, range),
                                    &range.lowest, &range.highest, format, flags);
    }
    note(name, "", tooltip);
    if (const auto given = set_for(name)) {
        const std::optional<double> wanted = number_word(*given);
        if (!wanted || *wanted < range.lowest || *wanted > range.highest) {
            refuse(name, *given, fmt::format("a number from {} to {}", range.lowest, range.highest));
        }
        changed = true;
        value = *wanted;
    }
    if (range.whole) value = std::round(value);
    return changed;
}

bool Controls::vector(const std::string& name, const char* text, double (&xyz)[3], const NumberControl& range,
                      const char* tooltip) {
    const double largest = std::max({std::abs(xyz[0]), std::abs(xyz[1]), std::abs(xyz[2])});
    bool changed =
        ImGui::DragScalarN(labelled(text, name).c_str(), ImGuiDataType_Double, xyz, 3, drag_speed(largest, range),
                           &range.lowest, &range.highest, "%.4g", ImGuiSliderFlags_AlwaysClamp);
    note(name, "", tooltip);
    if (const auto given = set_for(name)) {
        read_three(name, *given, xyz);
        changed = true;
    }
    return changed;
}

bool Controls::choice(const std::string& name, const char* text, std::size_t& index,
                      std::span<const std::string_view> words, const char* tooltip) {
    bool changed = false;
    const std::string shown(index < words.size() ? words[index] : std::string_view());
    const bool open = ImGui::BeginCombo(labelled(text, name).c_str(), shown.c_str());
    if (open) {
        for (std::size_t i = 0; i < words.size(); ++i) {
            if (ImGui::Selectable(std::string(words[i]).c_str(), i == index) && i != index) {
                index = i;
                changed = true;
            }
        }
        ImGui::EndCombo();
    } else {
        note(name, "", tooltip);
    }
    if (const auto given = set_for(name)) {
        const auto found = std::ranges::find(words, std::string_view(*given));
        if (found == words.end()) refuse(name, *given, fmt::format("one of {}", fmt::join(words, ", ")));
        changed = true;
        index = static_cast<std::size_t>(found - words.begin());
    }
    return changed;
}

bool Controls::color(const std::string& name, const char* text, float (&rgb)[3], const char* tooltip) {
    bool changed = ImGui::ColorEdit3(labelled(text, name).c_str(), rgb, ImGuiColorEditFlags_Float);
    note(name, "", tooltip);
    if (const auto given = set_for(name)) {
        read_three(name, *given, rgb);
        changed = true;
    }
    return changed;
}

bool Controls::text(const std::string& name, const char* label, std::string& value, const char* tooltip) {
    bool changed = ImGui::InputText(labelled(label, name).c_str(), &value, ImGuiInputTextFlags_EnterReturnsTrue);
    note(name, "", tooltip);
    if (auto given = set_for(name)) {
        value = std::move(*given);
        changed = true;
    }
    return changed;
}

}  // namespace matchlight
