// Reads and writes response.json: liberal in how a key is spelt, strict in what it means.
//
//   "srgb"                                                    the family alone, also as {"family": "srgb"}
//   {"family": "gamma", "gamma": 2.2}                         or one exponent a channel: [2.2, 2.2, 2.1]
//   {"family": "shoulder", "gamma": "srgb", "knee": 0.6, "white": 4}
//   {"family": "table", "linear": [...]}                      linear light at evenly spaced codes 0..1
//   {"family": "table", "code": [...], "linear": [...]}       pairs; codes in 0..1, or 0..code_max where that is given
//   {"family": "table", "code_from_linear": [...]}            codes at evenly spaced linear light 0..linear_max (1)
//   {"family": "table", "r": ..., "g": ..., "b": ...}         any of these a channel
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "calibration/response.h"
#include "core/atomic_file.h"
#include "core/error.h"

namespace matchlight {
namespace {

using nlohmann::json;
using Curve = Response::Curve;
using Family = Response::Family;

using Spellings = std::initializer_list<const char*>;

[[noreturn]] void fail(const std::filesystem::path& reported, const std::string& cause, const std::string& cure) {
    throw InputError(reported, cause, cure);
}

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return text;
}

const json* find_key(const json& object, Spellings spellings) {
    if (!object.is_object()) return nullptr;
    for (const char* spelling : spellings) {
        if (const auto found = object.find(spelling); found != object.end() && !found->is_null()) return &*found;
    }
    return nullptr;
}

std::string keys_of(const json& object) {
    std::string keys;
    for (const auto& item : object.items()) keys += (keys.empty() ? "" : ", ") + printable(item.key());
    return keys.empty() ? "nothing" : keys;
}

const Spellings family_keys{"family", "type", "kind", "response", "transfer"};
const Spellings gamma_keys{"gamma", "exponent", "power", "value"};
const Spellings knee_keys{"knee", "shoulder_start", "knee_linear"};
const Spellings white_keys{"white", "white_linear"};
const Spellings code_keys{"code", "codes", "code_values"};
const Spellings linear_keys{"linear", "linear_at_code", "linear_from_code", "values", "table", "curve", "samples",
                            "lut",    "light",          "inverse_response"};
const Spellings inverse_keys{"code_from_linear", "code_at_linear", "forward_response"};
const Spellings red_keys{"r", "red", "R"};
const Spellings green_keys{"g", "green", "G"};
const Spellings blue_keys{"b", "blue", "B"};

std::optional<Family> family_from_name(const std::string& name) {
    const std::string key = lower_case(name);
    if (key == "srgb" || key == "iec61966-2-1") return Family::srgb;
    if (key == "gamma" || key == "power") return Family::gamma;
    if (key == "shoulder") return Family::shoulder;
    if (key == "table" || key == "lut" || key == "curve") return Family::table;
    if (key == "pq" || key == "st2084" || key == "smpte2084") return Family::pq;
    if (key == "hlg" || key == "arib-std-b67") return Family::hlg;
    return std::nullopt;
}

double number(const json& value, const std::string& key, const std::filesystem::path& reported) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
        fail(reported, "\"" + key + "\" of the response is not a finite number", "give a number");
    }
    return value.get<double>();
}

double positive(const json& value, const std::string& key, const std::filesystem::path& reported) {
    const double found = number(value, key, reported);
    if (!(found > 0)) fail(reported, "\"" + key + "\" of the response is not positive", "give a number above 0");
    return found;
}

std::vector<double> numbers(const json& list, const std::string& key, const std::filesystem::path& reported) {
    if (!list.is_array()) fail(reported, "\"" + key + "\" of the response is not a list", "give a list of numbers");
    std::vector<double> values;
    values.reserve(list.size());
    for (const json& value : list) values.push_back(number(value, key, reported));
    return values;
}

std::vector<double> evenly_spaced(std::size_t samples, double end) {
    std::vector<double> values(samples);
    for (std::size_t i = 0; i < samples; ++i) {
        values[i] = end * static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(samples - 1, 1));
    }
    return values;
}

/// Scales that hold for all curves of a file.
struct TableScale {
    double code_max = 1;
    double linear_max = 1;
};

bool is_list_of_lists(const json& value, std::size_t inner) {
    return value.is_array() && !value.empty() && std::all_of(value.begin(), value.end(), [&](const json& row) {
               return row.is_array() && (inner == 0 || row.size() == inner);
           });
}

/// One channel's curve in any of the forms above.
std::optional<Curve> read_curve(const json& value, const TableScale& scale, const std::filesystem::path& reported) {
    Curve curve;
    if (is_list_of_lists(value, 2)) {  // pairs [code, linear]
        for (const json& pair : value) {
            curve.code.push_back(number(pair[0], "code", reported) / scale.code_max);
            curve.linear.push_back(number(pair[1], "linear", reported));
        }
        return curve;
    }
    if (value.is_array()) {
        curve.linear = numbers(value, "linear", reported);
        curve.code = evenly_spaced(curve.linear.size(), 1);
        return curve;
    }
    if (const json* inverse = find_key(value, inverse_keys)) {
        curve.code = numbers(*inverse, "code_from_linear", reported);
        for (double& code : curve.code) code /= scale.code_max;
        const json* linear = find_key(value, {"linear", "light"});
        curve.linear = linear != nullptr ? numbers(*linear, "linear", reported)
                                         : evenly_spaced(curve.code.size(), scale.linear_max);
        return curve;
    }
    const json* linear = find_key(value, linear_keys);
    if (linear == nullptr) return std::nullopt;
    const json* code = find_key(value, code_keys);
    if (code == nullptr) return read_curve(*linear, scale, reported);
    curve.linear = numbers(*linear, "linear", reported);
    curve.code = numbers(*code, "code", reported);
    for (double& c : curve.code) c /= scale.code_max;
    return curve;
}

/// "linear": [[r…], [g…], [b…]], or [[r, g, b], …], with common codes where they are given.
std::optional<std::array<Curve, 3>> read_joint_curves(const json& object, const TableScale& scale,
                                                      const std::filesystem::path& reported) {
    const json* rows = find_key(object, linear_keys);
    if (rows == nullptr || !is_list_of_lists(*rows, 0) || is_list_of_lists(*rows, 2)) return std::nullopt;
    std::array<Curve, 3> curves;
    if (rows->size() == 3 && (*rows)[0].size() != 3) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
            curves[channel].linear = numbers((*rows)[channel], "linear", reported);
        }
    } else if (rows->size() != 3 && is_list_of_lists(*rows, 3)) {
        for (const json& row : *rows) {
            for (std::size_t channel = 0; channel < 3; ++channel) {
                curves[channel].linear.push_back(number(row[channel], "linear", reported));
            }
        }
    } else {
        fail(reported, "the rows of the response table are neither three channels nor triples",
             "give \"r\", \"g\" and \"b\"");
    }
    std::vector<double> code = evenly_spaced(curves[0].linear.size(), 1);
    if (const json* given = find_key(object, code_keys)) {
        code = numbers(*given, "code", reported);
        for (double& c : code) c /= scale.code_max;
    }
    for (Curve& curve : curves) curve.code = code;
    return curves;
}

std::optional<std::array<Curve, 3>> read_curves(const json& object, const std::filesystem::path& reported) {
    TableScale scale;
    if (const json* value = find_key(object, {"code_max", "max_code"})) {
        scale.code_max = positive(*value, "code_max", reported);
    }
    if (const json* value = find_key(object, {"linear_max", "max_linear"})) {
        scale.linear_max = positive(*value, "linear_max", reported);
    }
    // Channels stand at the top, or inside the table's own key.
    const json* inner = find_key(object, linear_keys);
    const json& holder = inner != nullptr && inner->is_object() ? *inner : object;
    const std::array<const json*, 3> channels{find_key(holder, red_keys), find_key(holder, green_keys),
                                              find_key(holder, blue_keys)};
    const auto given = std::count_if(channels.begin(), channels.end(), [](const json* c) { return c != nullptr; });
    if (given == 3) {
        std::array<Curve, 3> curves;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            std::optional<Curve> curve = read_curve(*channels[channel], scale, reported);
            if (!curve) fail(reported, "a channel of the response table has no values", "give a list of linear light");
            // Codes that all channels share stand beside them.
            const json* code = find_key(holder, code_keys);
            if (code != nullptr && channels[channel]->is_array() && !is_list_of_lists(*channels[channel], 2)) {
                curve->code = numbers(*code, "code", reported);
                for (double& c : curve->code) c /= scale.code_max;
            }
            curves[channel] = std::move(*curve);
        }
        return curves;
    }
    if (given != 0)
        fail(reported, "the response table lacks a channel", "give \"r\", \"g\" and \"b\", or one \"linear\"");
    if (auto curves = read_joint_curves(object, scale, reported)) return curves;
    const std::optional<Curve> curve = read_curve(object, scale, reported);
    if (!curve) return std::nullopt;
    return std::array<Curve, 3>{*curve, *curve, *curve};
}

Response read_gamma(const json& object, const std::filesystem::path& reported) {
    const json* value = find_key(object, gamma_keys);
    if (value == nullptr) {
        fail(reported, "the gamma response has no \"gamma\" (found: " + keys_of(object) + ")", "give \"gamma\": 2.2");
    }
    if (value->is_array()) {
        if (value->size() != 3)
            fail(reported, "\"gamma\" of the response is a list of other than three", "give r, g, b");
        return Response::gamma({positive((*value)[0], "gamma", reported), positive((*value)[1], "gamma", reported),
                                positive((*value)[2], "gamma", reported)});
    }
    return Response::gamma(positive(*value, "gamma", reported));
}

Response read_shoulder(const json& object, const std::filesystem::path& reported) {
    Response::Shoulder shoulder;
    if (const json* value = find_key(object, {"gamma", "exponent", "base"})) {
        const bool is_srgb = value->is_string() && lower_case(value->get<std::string>()) == "srgb";
        shoulder.gamma = is_srgb ? 0 : positive(*value, "gamma", reported);
    }
    const json* knee = find_key(object, knee_keys);
    if (knee == nullptr) {
        fail(reported, "the shoulder response has no \"knee\" (found: " + keys_of(object) + ")",
             "give the linear light where the roll-off starts, such as \"knee\": 0.6");
    }
    shoulder.knee = positive(*knee, "knee", reported);
    if (const json* white = find_key(object, white_keys)) shoulder.white = positive(*white, "white", reported);
    return Response::shoulder(shoulder, reported);
}

Response read_table(const json& object, const std::filesystem::path& reported) {
    auto curves = read_curves(object, reported);
    if (!curves) {
        fail(reported, "the response table has no values (found: " + keys_of(object) + ")",
             "give \"linear\": [...] at evenly spaced codes, or \"code\" and \"linear\"");
    }
    return Response::from_curves(std::move(*curves), reported);
}

Family guess_family(const json& object, const std::filesystem::path& reported) {
    if (find_key(object, knee_keys) != nullptr) return Family::shoulder;
    if (find_key(object, gamma_keys) != nullptr) return Family::gamma;
    if (find_key(object, linear_keys) != nullptr || find_key(object, inverse_keys) != nullptr ||
        find_key(object, red_keys) != nullptr) {
        return Family::table;
    }
    fail(reported, "the response names no family (found: " + keys_of(object) + ")",
         "give \"family\": srgb, gamma, shoulder, table, pq or hlg");
}

json curve_to_json(const Curve& curve) {
    return json{{"code", curve.code}, {"linear", curve.linear}};
}

}  // namespace

Response Response::load(const std::filesystem::path& path) {
    constexpr std::size_t limit_bytes = 16u << 20;  // three channels of 65536 samples in full precision are 4 MB
    const std::string text = read_text_file(path, limit_bytes);
    try {
        // Nothing here nests deeper; the limit keeps a hostile file from exhausting the stack.
        constexpr int deepest = 8;
        return from_json(json::parse(text,
                                     [&](int depth, json::parse_event_t, json&) {
                                         if (depth > deepest) throw InputError(path, "nests too deep for a response");
                                         return true;
                                     }),
                         path);
    } catch (const json::exception& error) {
        throw InputError(path, std::string("this is no JSON: ") + error.what());
    }
}

Response Response::from_json(const json& given, const std::filesystem::path& reported) {
    json value = given;
    if (const json* parameters = find_key(given, {"parameters", "params"}); parameters && parameters->is_object()) {
        value.update(*parameters);
    }
    std::optional<Family> family;
    const json* name = value.is_string() ? &value : find_key(value, family_keys);
    if (name != nullptr) {
        const std::string text = name->is_string() ? name->get<std::string>() : name->dump();
        family = family_from_name(text);
        if (!family) {
            fail(reported, "the response family \"" + printable(text) + "\" is not known",
                 "use srgb, gamma, shoulder, table, pq or hlg");
        }
    } else if (value.is_array()) {
        family = Family::table;
    } else if (value.is_object()) {
        family = guess_family(value, reported);
    } else {
        fail(reported, "the response is neither a name nor an object", "give \"srgb\", or {\"family\": …}");
    }
    switch (*family) {
        case Family::srgb:
            return srgb();
        case Family::gamma:
            return read_gamma(value, reported);
        case Family::shoulder:
            return read_shoulder(value, reported);
        case Family::table:
            return read_table(value.is_array() ? json{{"linear", value}} : value, reported);
        case Family::pq:
            return pq();
        case Family::hlg:
            return hlg();
    }
    return srgb();
}

json Response::to_json() const {
    switch (family_) {
        case Family::srgb:
            return "srgb";
        case Family::pq:
            return "pq";
        case Family::hlg:
            return "hlg";
        case Family::gamma: {
            if (gamma_[0] == gamma_[1] && gamma_[1] == gamma_[2]) return {{"family", "gamma"}, {"gamma", gamma_[0]}};
            return {{"family", "gamma"}, {"gamma", gamma_}};
        }
        case Family::shoulder: {
            json object{{"family", "shoulder"}, {"knee", shoulder_.knee}};
            object["gamma"] = shoulder_.gamma > 0 ? json(shoulder_.gamma) : json("srgb");
            if (shoulder_.white > 0) object["white"] = shoulder_.white;
            return object;
        }
        case Family::table:
            return {{"family", "table"},
                    {"r", curve_to_json(curves_[0])},
                    {"g", curve_to_json(curves_[1])},
                    {"b", curve_to_json(curves_[2])}};
    }
    return "srgb";
}

}  // namespace matchlight
