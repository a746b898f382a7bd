// Synthetic cameras' responses found again from their photographs.
#include "calibration/response_fit.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibration/hdr_merge.h"
#include "core/error.h"
#include "report/synthetic_bracket.h"

namespace matchlight {
namespace {

/// A film-like S: code = (x/(x+0.18))-like shoulder over a toe, steepest in the middle tones.
Response film() {
    std::vector<double> code, linear;
    for (int i = 0; i <= 400; ++i) {
        const double light = std::exp2(-12 + 14.0 * i / 400) - std::exp2(-12);  // 0 to 4
        linear.push_back(light);
        code.push_back(std::pow(light, 0.85) / (std::pow(light, 0.85) + 0.25));
    }
    for (double& c : code) c /= code.back();
    const Response::Curve curve{code, linear};
    return Response::from_curves({curve, curve, curve}, "film");
}

ImageF scene() {
    // A ramp of light and a second one across it, so that every code lies beside others.
    ImageF radiance = radiance_ramp(360, 240, 11);
    for (int y = 0; y < radiance.height(); ++y) {
        const int strip = y / 40;
        for (int x = 0; x < radiance.width(); ++x) {
            for (int c = 0; c < 3; ++c) radiance.at(x, y, c) *= static_cast<float>(std::exp2(-0.37 * strip));
        }
    }
    return radiance;
}

/// A sensor of 50,000 electrons. Light at code 0.02 is some 0.0005 of full for these curves: noise well below it, or
/// nothing tells the curve there.
SyntheticCamera camera_of(const Response& response) {
    return {.response = response, .read_noise = 0.0001, .shot_noise = 0.00002};
}

/// The largest difference in EV over codes 0.02 to 0.98, the scale left free.
double worst_ev(const Response& found, const Response& truth, int channel) {
    std::vector<double> ratios;
    for (double code = 0.02; code <= 0.98; code += 0.01)
        ratios.push_back(std::log2(found.linear_from_code(code, channel) / truth.linear_from_code(code, channel)));
    const auto [least, greatest] = std::minmax_element(ratios.begin(), ratios.end());
    return (*greatest - *least) / 2;
}

class ResponseFitTest : public testing::Test {
protected:
    ResponseFitTest() { warnings_.set_quiet(true); }
    std::string error_of(const ExposureSeries& series) {
        try {
            fit_response(series, ResponseMethod::automatic, warnings_);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    }
    Warnings warnings_;
    const std::vector<double> exposures_ = {1, 4, 16, 64, 256};
};

TEST_F(ResponseFitTest, TheSimplestFamilyThatFitsIsChosenAndRight) {
    struct Case {
        const char* name;
        Response truth;
        ResponseMethod method;  // the simplest that holds it; a free curve may be either one
        double worst_ev;        // a code of 8 bits is 0.2 EV at code 0.02 of gamma 2.2
    };
    const Case cases[] = {{"sRGB", Response::srgb(), ResponseMethod::srgb, 0},
                          {"gamma 1.8", Response::gamma(1.8), ResponseMethod::gamma, 0.03},
                          {"gamma 2.6, 2.2, 1.9", Response::gamma({2.6, 2.2, 1.9}), ResponseMethod::gamma, 0.04},
                          {"film", film(), ResponseMethod::debevec, 0.12}};
    for (const Case& tried : cases) {
        SCOPED_TRACE(tried.name);
        const ResponseFit fit = fit_response(photographed(scene(), exposures_, camera_of(tried.truth)),
                                             ResponseMethod::automatic, warnings_);
        const bool free_curve = fit.method == ResponseMethod::debevec || fit.method == ResponseMethod::robertson;
        if (tried.method == ResponseMethod::debevec) {
            EXPECT_TRUE(free_curve);
        } else {
            EXPECT_EQ(fit.method, tried.method);
        }
        for (int c = 0; c < 3; ++c) EXPECT_LE(worst_ev(fit.response, tried.truth, c), tried.worst_ev) << c;
        EXPECT_LT(fit.residual_ev, 0.05);
    }
}

TEST_F(ResponseFitTest, FreeCurvesFindEveryCamera) {
    // Half a code of 255 at code 5, the least that is looked at, is 0.24 EV of gamma 1.8 and 0.2 of the film.
    constexpr double half_a_code_ev = 0.2;
    for (const ResponseMethod method : {ResponseMethod::debevec, ResponseMethod::robertson}) {
        SCOPED_TRACE(name_of(method));
        for (const Response& truth : {Response::srgb(), Response::gamma(1.8), film()}) {
            SCOPED_TRACE(truth.to_json().dump().substr(0, 30));
            const ResponseFit fit =
                fit_response(photographed(scene(), exposures_, camera_of(truth)), method, warnings_);
            for (int c = 0; c < 3; ++c) {
                EXPECT_LE(worst_ev(fit.response, truth, c), half_a_code_ev) << c;
                for (double code = 0; code < 0.999; code += 1.0 / 255) {
                    EXPECT_LT(fit.response.linear_from_code(code, c),
                              fit.response.linear_from_code(code + 1.0 / 255, c));
                }
            }
        }
    }
}

TEST_F(ResponseFitTest, ABorderThatIsNoPictureDoesNotCount) {
    const SyntheticCamera camera = camera_of(Response::gamma(1.8));
    ExposureSeries series = photographed(scene(), exposures_, camera);
    for (Photograph& shot : series.shots) {  // the same codes in every exposure
        for (int y = 0; y < 40; ++y) {
            for (int x = 0; x < series.width(); ++x) {
                shot.code.at(x, y, 0) = 0.1f;
                shot.code.at(x, y, 1) = 0.2f;
                shot.code.at(x, y, 2) = 0.7f;
            }
        }
    }
    const ResponseFit fit = fit_response(series, ResponseMethod::debevec, warnings_);
    for (int c = 0; c < 3; ++c) EXPECT_LE(worst_ev(fit.response, camera.response, c), 0.15) << c;
}

TEST_F(ResponseFitTest, MergesWithTheFoundCurveAreUnbiased) {
    SyntheticCamera camera;
    camera.response = film();
    const ImageF radiance = scene();
    const ExposureSeries series = photographed(radiance, exposures_, camera);
    const ResponseFit fit = fit_response(series, ResponseMethod::automatic, warnings_);
    const MergedPhotograph merged = merge_exposures(series, fit.response, {}, warnings_);
    std::vector<double> ratios;
    for (int y = 0; y < radiance.height(); y += 3) {
        for (int x = 40; x < radiance.width(); x += 3)
            ratios.push_back(std::log2(merged.radiance.at(x, y, 1) / radiance.at(x, y, 1)));
    }
    std::sort(ratios.begin(), ratios.end());
    const double middle = ratios[ratios.size() / 2];
    EXPECT_LT(ratios[ratios.size() * 9 / 10] - middle, 0.12);
    EXPECT_LT(middle - ratios[ratios.size() / 10], 0.12);
}

TEST_F(ResponseFitTest, RefusesWhatCannotTell) {
    const SyntheticCamera camera;
    EXPECT_NE(error_of(photographed(scene(), {1}, camera)).find("one photograph cannot tell"), std::string::npos);
    EXPECT_NE(error_of(photographed(ImageF(64, 64, 3, 0.0f), exposures_, camera)).find("cannot tell a response"),
              std::string::npos);
    EXPECT_NE(error_of(photographed(ImageF(64, 64, 3, 1e6f), exposures_, camera)).find("cannot tell a response"),
              std::string::npos);
}

}  // namespace
}  // namespace matchlight
