// The camera's response from bracketed photographs: the simplest family that predicts pixels left out as well as any.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/exposure_series.h"
#include "calibration/response.h"
#include "calibration/response_samples.h"
#include "core/warnings.h"

namespace matchlight {

enum class ResponseMethod { automatic, srgb, gamma, debevec, robertson };
std::string name_of(ResponseMethod method);

/// How well a response carries a pixel's code from one exposure to the next shorter one.
struct ResponseScore {
    ResponseMethod method = ResponseMethod::srgb;
    double held_out_codes = 0;            // root mean square over pixels left out, in parts of full code
    double excess = 0, excess_error = 0;  // mean square above the best family's, and its standard error
    bool chosen = false;
};

/// Mean difference and scatter in EV between what two exposures say of one light, by the code of the longer one.
struct ResidualBin {
    double code = 0;
    std::array<double, 3> mean_ev{}, sigma_ev{};  // NaN where few pixels are
};

struct ResponseFit {
    Response response = Response::srgb();
    ResponseMethod method = ResponseMethod::srgb;
    std::vector<ResponseScore> scores;  // of the families tried
    double residual_ev = 0;             // root mean square of the bins' means: what noise does not explain
    std::vector<ResidualBin> residuals;
    std::array<ResponseSamples::Span, 3> spans;  // codes that pixels told
    std::size_t places = 0;
};

/// Throws InputError where the photographs cannot tell a response. Warns where they tell it over part of the codes
/// only.
ResponseFit fit_response(const ExposureSeries& series, ResponseMethod method, Warnings& warnings);

}  // namespace matchlight
