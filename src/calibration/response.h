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
///  - shoulder: linear below a knee, a smooth roll-off above it (documented with its equation in response.cpp/README).
///  - table:    sampled linear light at evenly spaced codes, interpolated, strictly increasing.
/// pq and hlg exist for footage whose transfer tag says so.
class Response {
public:
    enum class Family { srgb, gamma, shoulder, table, pq, hlg };

    static Response srgb();
    static Response gamma(double exponent);
    /// Throws InputError (naming `reported`) for a table that is too short, not finite or not increasing.
    static Response table(std::array<std::vector<double>, 3> linear_at_code, const std::filesystem::path& reported);
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
    Family family_ = Family::srgb;
    std::array<double, 4> parameters_{};
    std::array<std::vector<double>, 3> linear_at_code_;
};

}  // namespace matchlight
