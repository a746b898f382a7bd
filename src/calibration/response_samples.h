// Pixels of a bracketed series that tell its camera's response: spread over the picture, even around themselves.
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/exposure_series.h"

namespace matchlight {

/// Codes of chosen places in every photograph, each the mean of 3 × 3 pixels.
class ResponseSamples {
public:
    /// Throws InputError where the photographs cannot tell a response: one alone, raw files, or too few places that two
    /// of them expose (Debevec & Malik 1997: N(P − 1) must exceed the number of codes).
    explicit ResponseSamples(const ExposureSeries& series);

    std::size_t places() const { return held_out_.size(); }
    std::size_t photographs() const { return log_exposures_.size(); }
    /// Natural logarithm; the longest exposure first.
    double log_exposure(std::size_t photograph) const { return log_exposures_[photograph]; }
    /// NaN where a pixel is full, and where pixels of its light may be black in that photograph.
    float code(std::size_t place, std::size_t photograph, int channel) const {
        return codes_[(place * photographs() + photograph) * 3 + static_cast<std::size_t>(channel)];
    }
    bool usable(std::size_t place, std::size_t photograph, int channel) const {
        return code(place, photograph, channel) == code(place, photograph, channel);
    }
    /// Every other block of the picture is left out of fits, to judge them by.
    bool held_out(std::size_t place) const { return held_out_[place]; }
    /// One of sixteen parts of the picture, to tell how sure a mean is.
    int part(std::size_t place) const { return parts_[place]; }
    static constexpr int part_count = 16;

    double code_step() const { return code_step_; }
    /// Where the camera ends: 1, or the largest code there is.
    float full_code() const { return full_code_; }
    /// Least and greatest usable code of a channel.
    struct Span {
        float least = 1, greatest = 0;
    };
    Span span(int channel) const;

private:
    void add_place(const ExposureSeries& series, int x, int y);
    void leave_out_drowned();

    std::vector<double> log_exposures_;
    std::vector<float> codes_;
    std::vector<bool> touches_black_;  // parallel to codes_
    std::vector<bool> held_out_;
    std::vector<int> parts_;
    double code_step_ = 1.0 / 255;
    float full_code_ = 1;
};

}  // namespace matchlight
