// matchlight response: the camera's response from bracketed photographs.
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibration/exposure_series.h"
#include "calibration/response_fit.h"
#include "calibration/response_page.h"
#include "commands/command.h"
#include "commands/photograph_options.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/version.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct ResponseCall {
    PhotographOptions photographs;
    fs::path output;
    ResponseMethod method = ResponseMethod::automatic;
    bool no_report = false, overwrite = false;
};

/// What the scene's `response` key reads, with where it came from beside it.
json response_file(const ResponseFit& fit, const ExposureSeries& series) {
    json file = fit.response.to_json();
    if (file.is_string()) file = json{{"family", file}};
    json photographs = json::array();
    for (const Photograph& shot : series.shots) {
        json entry = record_json(shot);
        entry["file"] = shot.path.filename().string();
        photographs.push_back(entry);
    }
    file["fitted"] = {{"software", std::string("matchlight ") + version},
                      {"method", name_of(fit.method)},
                      {"residual_ev", fit.residual_ev},
                      {"photographs", photographs}};
    return file;
}

json result_json(const ResponseCall& call, const ResponseFit& fit) {
    json result{{"file", call.output.string()}, {"method", name_of(fit.method)}, {"residual_ev", fit.residual_ev},
                {"places", fit.places},         {"families", json::array()},     {"residuals", json::array()},
                {"told_codes", json::array()}};
    for (const ResponseScore& score : fit.scores) {
        result["families"].push_back({{"family", name_of(score.method)},
                                      {"held_out_codes", 255 * score.held_out_codes},
                                      {"excess", 255 * 255 * score.excess},
                                      {"excess_error", 255 * 255 * score.excess_error},
                                      {"chosen", score.chosen}});
    }
    for (const ResidualBin& bin : fit.residuals) {
        json mean = json::array(), sigma = json::array();
        for (std::size_t c = 0; c < 3; ++c) {
            mean.push_back(std::isnan(bin.mean_ev[c]) ? json() : json(bin.mean_ev[c]));
            sigma.push_back(std::isnan(bin.sigma_ev[c]) ? json() : json(bin.sigma_ev[c]));
        }
        result["residuals"].push_back({{"code", bin.code}, {"mean_ev", mean}, {"sigma_ev", sigma}});
    }
    for (const ResponseSamples::Span& span : fit.spans) result["told_codes"].push_back({span.least, span.greatest});
    return result;
}

std::string result_text(const ResponseCall& call, const ResponseFit& fit, const ExposureSeries& series) {
    std::string text = fmt::format("{}: {}, from {} photographs and {} places\n", call.output.string(),
                                   name_of(fit.method), series.shots.size(), fit.places);
    if (fit.response.family() == Response::Family::gamma) {
        const json gamma = fit.response.to_json()["gamma"];
        text += fmt::format("  exponents of red, green, blue: {}\n", gamma.dump());
    }
    for (const ResponseScore& score : fit.scores) {
        text += fmt::format("  {:<10} pixels left out are predicted to {:.3f} codes of 255{}\n", name_of(score.method),
                            255 * score.held_out_codes, score.chosen ? ", chosen" : "");
    }
    return text + fmt::format("two exposures of one light agree to {:.3f} EV (root mean square over the codes)\n",
                              fit.residual_ev);
}

void run_response(const ResponseCall& call, CommandContext& context) {
    check_not_an_input(call.output, call.photographs.photographs);
    check_output(call.output, call.overwrite);
    const OutputLock lock(call.output);
    std::optional<fs::path> page;
    if (!call.no_report) {
        page = fs::path(call.output).replace_extension(".html");
        if (*page == call.output) throw InputError(call.output, "the response is written as .json");
        check_output(*page, call.overwrite);
    }
    const ExposureSeries series = read_photographs(call.photographs, context.warnings);
    const ResponseFit fit = fit_response(series, call.method, context.warnings);
    if (page) write_text_file(*page, response_page(fit, series));
    write_text_file(call.output, response_file(fit, series).dump(1) + "\n");
    json result = result_json(call, fit);
    if (page) result["report"] = page->string();
    print_result(context, result, result_text(call, fit, series));
}

}  // namespace

void add_response_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("response", "The camera's response from bracketed photographs");
    const auto call = std::make_shared<ResponseCall>();
    add_photograph_options(*command, call->photographs);
    command->add_option("-o,--output", call->output, "Where to write: .json, which a scene's `response` reads")
        ->required();
    const std::map<std::string, ResponseMethod> methods{{"auto", ResponseMethod::automatic},
                                                        {"srgb", ResponseMethod::srgb},
                                                        {"gamma", ResponseMethod::gamma},
                                                        {"debevec", ResponseMethod::debevec},
                                                        {"robertson", ResponseMethod::robertson}};
    command
        ->add_option("--method", call->method,
                     "auto (default: the simplest that predicts pixels left out as well as any), srgb, gamma (an "
                     "exponent a channel), debevec (Debevec & Malik 1997), robertson (Robertson et al. 2003)")
        ->transform(CLI::CheckedTransformer(methods).description("{auto,srgb,gamma,debevec,robertson}"));
    command->add_flag("--no-report", call->no_report, "No page beside the file");
    command->add_flag("--overwrite", call->overwrite, "Replace files that exist");
    command->callback([call, &context] { run_response(*call, context); });
}

}  // namespace matchlight
