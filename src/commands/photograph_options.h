// What the commands on bracketed photographs share: which photographs, and what is said of their exposures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "calibration/exposure_series.h"
#include "calibration/response.h"
#include "core/warnings.h"

namespace matchlight {

struct PhotographOptions {
    std::vector<std::filesystem::path> photographs;
    std::vector<std::string> times;
    std::vector<double> f_numbers, isos;
};

/// PHOTOS, --times, --f-numbers, --iso.
void add_photograph_options(CLI::App& command, PhotographOptions& options);
/// The latter three alone.
void add_exposure_options(CLI::App& command, PhotographOptions& options);

/// Throws InputError.
ExposureSeries read_photographs(const PhotographOptions& options, Warnings& warnings);

/// What --response names: a file, or a family: "srgb", "linear", "gamma=2.2". Throws InputError.
Response response_of(const std::string& text);

/// "1/30 s", "2.5 s", with f-number and ISO where they are known.
std::string record_text(const ExposureRecord& record);
nlohmann::json record_json(const Photograph& shot);

/// Throws InputError when the output is one of the photographs.
void check_not_an_input(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs);

}  // namespace matchlight
