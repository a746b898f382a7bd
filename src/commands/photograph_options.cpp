// Options of bracketed photographs.
#include "commands/photograph_options.h"

#include <cmath>
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
