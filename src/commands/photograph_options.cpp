// Options of bracketed photographs.
#include "commands/photograph_options.h"

#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {

namespace fs = std::filesystem;

void add_photograph_options(CLI::App& command, PhotographOptions& options) {
    command
        .add_option("PHOTOS", options.photographs,
                    "Photographs of one scene from one place, exposed differently, in any order: JPEG, PNG, TIFF, or "
                    "raw files where OpenImageIO has LibRaw")
        ->required();
    add_exposure_options(command, options);
}

void add_exposure_options(CLI::App& command, PhotographOptions& options) {
    command
        .add_option("--times", options.times,
                    "Exposure times in seconds, one a photograph in their order: 1/30,1/60,0.5 (default: EXIF)")
        ->delimiter(',')
        ->type_name("SECONDS");
    command.add_option("--f-numbers", options.f_numbers, "F-numbers, one a photograph or one for all (default: EXIF)")
        ->delimiter(',')
        ->type_name("N");
    command.add_option("--iso", options.isos, "ISO values, one a photograph or one for all (default: EXIF)")
        ->delimiter(',')
        ->type_name("ISO");
}

ExposureSeries read_photographs(const PhotographOptions& options, Warnings& warnings) {
    ExposureOptions given;
    for (const std::string& time : options.times) given.times_s.push_back(seconds_from_text(time));
    given.f_numbers = options.f_numbers;
    given.isos = options.isos;
    return read_exposure_series(options.photographs, given, warnings);
}

Response response_of(const std::string& text) {
    if (text == "srgb") return Response::srgb();
    if (text == "linear") return Response::gamma(1);
    constexpr std::string_view gamma = "gamma=";
    if (!text.starts_with(gamma)) return Response::load(text);
    double exponent = 0;
    const auto [end, error] = std::from_chars(text.data() + gamma.size(), text.data() + text.size(), exponent);
    // No camera's curve is outside of these.
    if (error != std::errc() || end != text.data() + text.size() || !(exponent >= 0.1 && exponent <= 10))
        throw InputError({}, fmt::format("'{}' is no response", text), "give an exponent from 0.1 to 10: gamma=2.2");
    return Response::gamma(exponent);
}

std::string record_text(const ExposureRecord& record) {
    const double seconds = record.exposure_s;
    std::string text = seconds > 0.3    ? fmt::format("{:.3g} s", seconds)
                       : seconds > 0.01 ? fmt::format("1/{:.3g} s", 1 / seconds)
                                        : fmt::format("1/{:.0f} s", 1 / seconds);
    if (record.f_number > 0) text += fmt::format(" f/{:.3g}", record.f_number);
    if (record.iso > 0) text += fmt::format(" ISO {:g}", record.iso);
    return text;
}

nlohmann::json record_json(const Photograph& shot) {
    nlohmann::json json{{"file", shot.path.string()}, {"exposure_s", shot.record.exposure_s}};
    if (shot.record.f_number > 0) json["f_number"] = shot.record.f_number;
    if (shot.record.iso > 0) json["iso"] = shot.record.iso;
    return json;
}

void check_not_an_input(const fs::path& output, const std::vector<fs::path>& inputs) {
    for (const fs::path& input : inputs) {
        std::error_code error;
        if (input == output || fs::equivalent(input, output, error))
            throw InputError(output, "the output is the input", "give another name");
    }
}

}  // namespace matchlight
