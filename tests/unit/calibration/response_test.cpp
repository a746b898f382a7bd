// Response curves: known values, inverses, continuity, and the spellings of response.json.
#include "calibration/response.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/transfer.h"

namespace matchlight {
namespace {

using nlohmann::json;

Response parse(const std::string& text) {
    return Response::from_json(json::parse(text), "response.json");
}

std::string error_of(const std::string& text) {
    try {
        parse(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

/// One of every family, with the largest error allowed after a round trip.
std::vector<Response> every_family() {
    std::vector<double> linear;
    for (int i = 0; i <= 64; ++i) linear.push_back(std::pow(i / 64.0, 2.0) * 0.9 + i * 1e-3);
    return {Response::srgb(),
            Response::gamma(2.2),
            Response::gamma({1.8, 2.2, 2.6}),
            Response::shoulder({0, 0.6, 0}, "r.json"),
            Response::shoulder({2.2, 0.3, 0}, "r.json"),
            Response::shoulder({0, 0.5, 4}, "r.json"),
            Response::table({linear, linear, linear}, "r.json"),
            Response::pq(),
            Response::hlg()};
}

TEST(Response, InvertsAndRisesInAndBeyondTheCodeRange) {
    for (const Response& response : every_family()) {
        for (int channel = 0; channel < 3; ++channel) {
            double last = -std::numeric_limits<double>::infinity();
            for (double code = -0.1; code <= 1.1; code += 1.0 / 2046) {
                const double linear = response.linear_from_code(code, channel);
                ASSERT_TRUE(std::isfinite(linear)) << static_cast<int>(response.family()) << " at " << code;
                EXPECT_GE(linear, last) << static_cast<int>(response.family()) << " at " << code;
                last = linear;
                // PQ is flat below about 1e-3, where its code is no longer resolved by the light in doubles.
                if (response.family() == Response::Family::pq && std::abs(code) < 0.002) continue;
                EXPECT_NEAR(response.code_from_linear(linear, channel), code, 1e-9)
                    << static_cast<int>(response.family()) << " at " << code;
            }
        }
    }
}

TEST(Response, KnownValues) {
    EXPECT_NEAR(Response::srgb().linear_from_code(0.5, 0), 0.21404114048223255, 1e-15);  // IEC 61966-2-1
    EXPECT_NEAR(Response::gamma(2.2).linear_from_code(0.5, 1), std::pow(0.5, 2.2), 1e-15);
    EXPECT_NEAR(Response::hlg().linear_from_code(0.5, 2), 1.0 / 12, 1e-15);  // BT.2100: the joint of its two pieces
    EXPECT_NEAR(Response::pq().code_from_linear(0.01, 0), 0.508078, 1e-6);   // ST 2084: 100 cd/m²
}

TEST(Shoulder, IsTheBaseCurveBelowTheKneeAndSmoothAtIt) {
    for (const double white : {0.0, 3.0}) {
        for (const double gamma : {0.0, 2.4}) {
            const double knee = 0.4;
            const Response response = Response::shoulder({gamma, knee, white}, "r.json");
            const auto base = [&](double linear) {
                return gamma > 0 ? std::pow(linear, 1 / gamma) : srgb_code_from_linear(linear);
            };
            for (double linear = 0; linear <= knee; linear += 0.05) {
                EXPECT_DOUBLE_EQ(response.code_from_linear(linear, 0), base(linear));
            }
            const double h = 1e-6;
            const double below = (base(knee) - base(knee - h)) / h;
            const double above = (response.code_from_linear(knee + h, 0) - base(knee)) / h;
            EXPECT_NEAR(above, below, 1e-4 * below);  // second derivatives differ: O(h)
            EXPECT_LT(response.code_from_linear(0.9, 0), base(0.9));
        }
    }
}

TEST(Shoulder, FollowsItsEquation) {
    const double knee = 0.6, a = srgb_code_from_linear(knee);
    const double slope = 1.055 / 2.4 * std::pow(knee, 1 / 2.4 - 1);
    const Response open_end = Response::shoulder({0, knee, 0}, "r.json");
    for (const double linear : {0.7, 1.0, 1.5, 2.0}) {
        const double expected = a + (1 - a) * (1 - std::exp(-slope * (linear - knee) / (1 - a)));
        EXPECT_NEAR(open_end.code_from_linear(linear, 0), expected, 1e-14);
    }
    // With white given, that light has code 1.
    EXPECT_NEAR(Response::shoulder({0, knee, 4}, "r.json").code_from_linear(4, 0), 1, 1e-12);
    EXPECT_NEAR(Response::shoulder({0, knee, 4}, "r.json").linear_from_code(1, 0), 4, 1e-9);
}

TEST(Shoulder, RejectsWhatNoCurveCanDo) {
    EXPECT_THROW(Response::shoulder({0, 0, 0}, "r.json"), InputError);
    EXPECT_THROW(Response::shoulder({0, 1, 0}, "r.json"), InputError);
    EXPECT_THROW(Response::shoulder({0, 0.6, 0.7}, "r.json"), InputError);  // the tangent gets to code 1 at 0.93
    EXPECT_THROW(Response::shoulder({-1, 0.6, 0}, "r.json"), InputError);
}

TEST(Table, InterpolatesAndContinues) {
    const Response response = parse(R"({"family": "table", "linear": [0, 0.1, 0.4, 1]})");
    EXPECT_NEAR(response.linear_from_code(1.0 / 3, 0), 0.1, 1e-15);
    EXPECT_NEAR(response.linear_from_code(0.5, 1), 0.25, 1e-15);
    EXPECT_NEAR(response.code_from_linear(0.25, 2), 0.5, 1e-15);
    EXPECT_NEAR(response.linear_from_code(1.1, 0), 1 + 0.1 * 1.8, 1e-14);
    EXPECT_NEAR(response.linear_from_code(-0.1, 0), -0.03, 1e-14);
}

TEST(ResponseJson, ReadsEveryForm) {
    for (const char* text : {R"("srgb")", R"({"family": "srgb"})", R"({"type": "sRGB"})"}) {
        EXPECT_EQ(parse(text).family(), Response::Family::srgb) << text;
    }
    for (const char* text : {R"({"family": "gamma", "gamma": 2.2})", R"({"type": "power", "exponent": 2.2})",
                             R"({"gamma": 2.2})", R"({"family": "gamma", "parameters": {"gamma": 2.2}})"}) {
        EXPECT_NEAR(parse(text).linear_from_code(0.5, 0), std::pow(0.5, 2.2), 1e-15) << text;
    }
    EXPECT_NEAR(parse(R"({"family": "gamma", "gamma": [1, 2, 3]})").linear_from_code(0.5, 2), 0.125, 1e-15);
    EXPECT_EQ(parse(R"({"family": "shoulder", "gamma": "srgb", "knee": 0.6})").family(), Response::Family::shoulder);

    // All of these say: the light at code 0.5 is 0.25.
    for (const char* text :
         {R"({"family": "table", "linear": [0, 0.25, 1]})", R"({"table": [0, 0.25, 1]})",
          R"({"family": "table", "values": [0, 0.25, 1]})",
          R"({"family": "table", "code": [0, 0.5, 1], "linear": [0, 0.25, 1]})",
          R"({"family": "table", "code": [0, 127.5, 255], "code_max": 255, "linear": [0, 0.25, 1]})",
          R"({"family": "table", "curve": [[0, 0], [0.5, 0.25], [1, 1]]})",
          R"({"family": "table", "curve": [[0, 0], [0.25, 0.125], [0.5, 0.25], [1, 1]]})",
          R"({"family": "table", "code_from_linear": [0, 0.5, 0.7, 0.9, 1]})",
          R"({"family": "table", "r": [0, 0.25, 1], "g": [0, 0.25, 1], "b": [0, 0.25, 1]})",
          R"({"family": "table", "linear": {"r": [0, 0.25, 1], "g": [0, 0.25, 1], "b": [0, 0.25, 1]}})",
          R"({"family": "table", "code": [0, 0.5, 0.8, 1], "red": [0, 0.25, 0.7, 1],
                                 "green": [0, 0.25, 0.7, 1], "blue": [0, 0.25, 0.7, 1]})",
          R"({"family": "table", "linear": [[0, 0, 0], [0.1, 0.1, 0.1], [0.25, 0.25, 0.25],
                                 [0.5, 0.5, 0.5], [1, 1, 1]]})",
          R"({"family": "table", "linear": [[0, 0.1, 0.25, 0.5, 1], [0, 0.1, 0.25, 0.5, 1],
                                 [0, 0.1, 0.25, 0.5, 1]]})"}) {
        const Response response = parse(text);
        EXPECT_EQ(response.family(), Response::Family::table) << text;
        for (int channel = 0; channel < 3; ++channel) {
            EXPECT_NEAR(response.linear_from_code(0.5, channel), 0.25, 1e-15) << text;
        }
    }
}

TEST(ResponseJson, NamesWhatIsWrong) {
    const auto expect_error = [](const std::string& text, const std::string& part) {
        const std::string error = error_of(text);
        EXPECT_NE(error.find(part), std::string::npos) << text << ": " << error;
        EXPECT_NE(error.find("response.json"), std::string::npos) << error;
    };
    expect_error(R"({"family": "logc"})", "not known");
    expect_error(R"({"family": "gamma"})", "no \"gamma\"");
    expect_error(R"({"family": "gamma", "gamma": 0})", "not positive");
    expect_error(R"({"family": "gamma", "gamma": "2.2"})", "not a finite number");
    expect_error(R"({"family": "shoulder"})", "knee");
    expect_error(R"({"family": "table"})", "no values");
    expect_error(R"({"family": "table", "linear": [0]})", "too short");
    expect_error(R"({"family": "table", "linear": [0, 0.5, 0.5, 1]})", "does not increase at sample 2");
    expect_error(R"({"family": "table", "linear": [0, 1], "code": [0, 0.5, 1]})", "3 codes for 2");
    expect_error(R"({"family": "table", "linear": [0, 1], "code": [0, 255]})", "outside 0..1");
    expect_error(R"({"family": "table", "linear": [0, null]})", "not a finite number");
    expect_error(R"({"family": "table", "r": [0, 1], "g": [0, 1]})", "lacks a channel");
    expect_error(R"({"curve_name": 1})", "names no family");
    expect_error("3", "neither a name nor an object");
}

TEST(ResponseJson, WritesWhatItReads) {
    for (const Response& response : every_family()) {
        const Response again = Response::from_json(response.to_json(), "again.json");
        EXPECT_EQ(again.family(), response.family());
        for (double code = 0; code <= 1; code += 0.01) {
            for (int channel = 0; channel < 3; ++channel) {
                EXPECT_EQ(again.linear_from_code(code, channel), response.linear_from_code(code, channel));
            }
        }
    }
}

TEST(SampledLinear, IsTheCurveAtEvenCodes) {
    const std::vector<float> samples = Response::srgb().sampled_linear(256, 1);
    ASSERT_EQ(samples.size(), 256u);
    for (int i = 0; i < 256; ++i) EXPECT_FLOAT_EQ(samples[i], static_cast<float>(linear_from_srgb_code(i / 255.0)));
}

}  // namespace
}  // namespace matchlight
