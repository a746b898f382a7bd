// The camera's response: code value (0..1 of full scale) against scene-linear light (1 = the light that gives code 1).
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace matchlight {

/// A monotone curve for each channel. Families:
///  - srgb:     IEC 61966-2-1.
///  - gamma:    linear = code^gamma.
///  - shoulder: sRGB or gamma below a knee, a smooth exponential roll-off above it (Shoulder, below).
///  - table:    pairs of code and linear light, both strictly increasing, interpolated linearly, continued with the
///              slopes of the ends.
/// pq and hlg exist for footage whose transfer tag says so.
class Response {
public:
    enum class Family { srgb, gamma, shoulder, table, pq, hlg };

    static Response srgb();
    static Response gamma(double exponent);
    /// An exponent for each channel.
    static Response gamma(const std::array<double, 3>& exponent);

    /// With g the base curve (code of linear), k the knee and a = g(k), light above the knee has the code
    ///     code = a + (1 − a)·(1 − exp(−c·t)) / (1 − exp(−c·T)),   t = linear − k, T = white − k,
    /// where c makes the slope at the knee that of the base curve, so that curve and slope are continuous. With white
    /// at infinity c = g'(k) / (1 − a), and code 1 would need infinite light: the last half code of ten bits
    /// (code > 1 − 0.5/1023) follows the tangent instead, which keeps both directions finite.
    struct Shoulder {
        double gamma = 0;   // of the base curve; 0 = sRGB
        double knee = 0.6;  // linear light where the roll-off starts, in (0, 1) as the base curve counts it
        double white = 0;   // linear light of code 1, beyond where the tangent at the knee gets there; 0 = infinity
    };
    /// Throws InputError (naming `reported`) for a knee outside (0, 1) or a white that the roll-off cannot reach.
    static Response shoulder(const Shoulder& shoulder, const std::filesystem::path& reported);

    /// Linear light at evenly spaced codes 0..1. Throws InputError (naming `reported`) for a table that is too short,
    /// not finite or not increasing.
    static Response table(std::array<std::vector<double>, 3> linear_at_code, const std::filesystem::path& reported);
    /// Corresponding codes (0..1) and linear light, on any codes. Throws as above.
    struct Curve {
        std::vector<double> code;
        std::vector<double> linear;
    };
    static Response from_curves(std::array<Curve, 3> curves, const std::filesystem::path& reported);
    static Response pq();
    static Response hlg();
    /// Reads response.json. Throws InputError with the wrong key and the cure.
    static Response load(const std::filesystem::path& path);
    static Response from_json(const nlohmann::json& json, const std::filesystem::path& reported);
    nlohmann::json to_json() const;

    Family family() const { return family_; }

    /// `channel` 0..2 = R, G, B. Code outside 0..1 (head- and footroom) is continued, monotone.
    double linear_from_code(double code, int channel) const;
    double code_from_linear(double linear, int channel) const;

    /// Evenly spaced samples of linear_from_code over [0, 1], for look-up on the GPU and for 8- and 10-bit footage.
    std::vector<float> sampled_linear(int samples, int channel) const;

private:
    /// Where the shoulder's pieces join, worked out once.
    struct RollOff {
        double knee_code = 0;
        double rate = 0;        // c
        double span = 0;        // (1 − a) / (1 − exp(−c·T))
        double tail_light = 0;  // t from which the tangent is followed
        double tail_code = 0;
        double tail_slope = 0;
    };

    double base_linear_from_code(double code) const;
    double base_code_from_linear(double linear) const;

    Family family_ = Family::srgb;
    std::array<double, 3> gamma_{};
    Shoulder shoulder_;
    RollOff roll_off_;
    std::array<Curve, 3> curves_;
};

}  // namespace matchlight
