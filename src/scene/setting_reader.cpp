// Types, ranges and files of single settings.
#include "scene/setting_reader.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/error.h"
#include "media/image_io.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

std::optional<std::int64_t> line_of(const toml::source_region& region) {
    if (!region.begin) return std::nullopt;
    return static_cast<std::int64_t>(region.begin.line);
}

std::string place_name(const Setting& setting) {
    return fmt::format("'{}' in [{}]", setting.key, written_section(setting.section));
}

/// A value as an error line can hold it.
std::string excerpt(const toml::node& node) {
    constexpr std::size_t longest = 60;
    const std::string text = toml_text(node);
    return text.size() <= longest ? text : text.substr(0, longest) + "…";
}

[[noreturn]] void wrong_type(const SceneSource& source, const Setting& setting, const toml::node& node) {
    source.fail(node, fmt::format("{} is {}, not {}", place_name(setting), excerpt(node), describe(setting.domain)));
}

void check_range(const SceneSource& source, const Setting& setting, const toml::node& node, double value) {
    const SettingDomain& domain = setting.domain;
    if (!std::isfinite(value)) source.fail(node, fmt::format("{} is not finite", place_name(setting)));
    const bool too_low = domain.above_lowest ? value <= domain.lowest : value < domain.lowest;
    if (too_low || value > domain.highest) {
        source.fail(node, fmt::format("{} is {}, outside its range ({})", place_name(setting), excerpt(node),
                                      describe(domain)));
    }
}

double number_of(const SceneSource& source, const Setting& setting, const toml::node& node) {
    if (!node.is_number()) wrong_type(source, setting, node);
    const double value = *node.value<double>();
    check_range(source, setting, node, value);
    return value;
}

std::string text_of(const SceneSource& source, const Setting& setting, const toml::node& node) {
    const auto text = node.value_exact<std::string>();
    if (!text) wrong_type(source, setting, node);
    if (text->find('\0') != std::string::npos) {
        source.fail(node, fmt::format("{} holds a zero byte", place_name(setting)));
    }
    return *text;
}

Eigen::Vector3d vector_of(const SceneSource& source, const Setting& setting, const toml::node& node) {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != 3) wrong_type(source, setting, node);
    Eigen::Vector3d vector;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!(*array)[i].is_number()) wrong_type(source, setting, node);
        vector[static_cast<Eigen::Index>(i)] = number_of(source, setting, (*array)[i]);
    }
    return vector;
}

Eigen::Vector3d interval_of(const SceneSource& source, const Setting& setting, const toml::node& node) {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != 2) wrong_type(source, setting, node);
    const Eigen::Vector3d ends(number_of(source, setting, (*array)[0]), number_of(source, setting, (*array)[1]), 0);
    if (!(ends.x() < ends.y())) {
        source.fail(node, fmt::format("{} is {}, which does not ascend", place_name(setting), excerpt(node)));
    }
    return ends;
}

std::size_t choice_of(const SceneSource& source, const Setting& setting, const toml::node& node) {
    const std::string word = text_of(source, setting, node);
    const auto& choices = setting.domain.choices;
    const auto found = std::find(choices.begin(), choices.end(), word);
    if (found == choices.end()) {
        source.fail(node,
                    fmt::format("{} is '{}', not one of: {}", place_name(setting), word, describe(setting.domain)),
                    fmt::format("did you mean '{}'?", nearest_word(word, choices)));
    }
    return static_cast<std::size_t>(found - choices.begin());
}

void check_input_file(const SceneSource& source, const Setting& setting, const toml::node& node, const fs::path& path) {
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    if (!fs::exists(status)) {
        source.fail(node, fmt::format("{}: there is no file '{}'", place_name(setting), path.string()));
    }
    if (!fs::is_regular_file(status)) {
        source.fail(node, fmt::format("{}: '{}' is not a regular file", place_name(setting), path.string()));
    }
}

fs::path path_of(const SceneSource& source, const Setting& setting, const toml::node& node) {
    const std::string written = text_of(source, setting, node);
    if (written.empty()) source.fail(node, fmt::format("{} is empty", place_name(setting)));
    return source.resolved(written);
}

}  // namespace

fs::path SceneSource::resolved(const std::string& written) const {
    return path.parent_path() / written;
}

void SceneSource::fail(const toml::node& node, const std::string& cause, const std::string& cure) const {
    throw InputError(InputErrorParts{path, std::nullopt, cause, cure, line_of(node.source())});
}

void SceneSource::fail(const toml::key& key, const std::string& cause, const std::string& cure) const {
    throw InputError(InputErrorParts{path, std::nullopt, cause, cure, line_of(key.source())});
}

SettingValue read_setting(const SceneSource& source, const Setting& setting, const toml::node& node) {
    SettingValue value;
    switch (setting.domain.kind) {
        case SettingKind::boolean: {
            const auto flag = node.value_exact<bool>();
            if (!flag) wrong_type(source, setting, node);
            value.boolean = *flag;
            break;
        }
        case SettingKind::integer:
            if (!node.is_integer()) wrong_type(source, setting, node);
            value.integer = *node.value_exact<std::int64_t>();
            check_range(source, setting, node, static_cast<double>(value.integer));
            break;
        case SettingKind::number:
            value.number = number_of(source, setting, node);
            break;
        case SettingKind::text:
            value.text = text_of(source, setting, node);
            if (value.text.empty()) source.fail(node, fmt::format("{} is empty", place_name(setting)));
            break;
        case SettingKind::choice:
            value.choice = choice_of(source, setting, node);
            value.text = setting.domain.choices[value.choice];
            break;
        case SettingKind::measure:
            if (node.is_string()) {
                value.choice = choice_of(source, setting, node);
                value.text = setting.domain.choices[value.choice];
            } else {
                value.number = number_of(source, setting, node);
            }
            break;
        case SettingKind::color:
        case SettingKind::vector:
            value.vector = vector_of(source, setting, node);
            break;
        case SettingKind::interval:
            value.vector = interval_of(source, setting, node);
            break;
        case SettingKind::scale:
            value.vector = node.is_number() ? Eigen::Vector3d::Constant(number_of(source, setting, node)).eval()
                                            : vector_of(source, setting, node);
            break;
        case SettingKind::rotation:
            value.vector = node.is_number() ? Eigen::Vector3d(0, 0, number_of(source, setting, node))
                                            : vector_of(source, setting, node);
            break;
        case SettingKind::input_file:
            // A word that stands for itself; a file of that name is "./word".
            if (const std::string written = text_of(source, setting, node);
                std::ranges::find(setting.domain.choices, written) != setting.domain.choices.end()) {
                value.text = written;
                break;
            }
            value.path = path_of(source, setting, node);
            check_input_file(source, setting, node, value.path);
            break;
        case SettingKind::footage:
            value.path = path_of(source, setting, node);
            // The files of a numbered sequence are looked for where they are opened.
            if (!is_pattern(value.path)) check_input_file(source, setting, node, value.path);
            break;
        case SettingKind::any_file:
            value.path = path_of(source, setting, node);
            break;
        case SettingKind::section:
        case SettingKind::sections:
        case SettingKind::effect:
        case SettingKind::left_out:
        case SettingKind::not_built:
            assert(false);
    }
    return value;
}

std::string toml_text(const toml::node& node) {
    if (const auto* array = node.as_array()) {
        std::vector<std::string> items;
        for (const toml::node& item : *array) items.push_back(toml_text(item));
        return fmt::format("[{}]", fmt::join(items, ", "));
    }
    if (const auto* table = node.as_table()) {
        std::vector<std::string> items;
        for (const auto& [key, item] : *table) {
            items.push_back(fmt::format("{} = {}", std::string_view(key), toml_text(item)));
        }
        return fmt::format("{{{}}}", fmt::join(items, ", "));
    }
    if (const auto text = node.value_exact<std::string>()) {
        std::string quoted = "\"";
        for (const char c : *text) {
            if (c == '"' || c == '\\') {
                quoted += '\\';
                quoted += c;
            } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
                quoted += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
            } else {
                quoted += c;
            }
        }
        return quoted + "\"";
    }
    if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);
    if (const auto integer = node.value_exact<std::int64_t>()) return fmt::format("{}", *integer);
    if (const auto flag = node.value_exact<bool>()) return *flag ? "true" : "false";
    return "a date or time";
}

}  // namespace matchlight
