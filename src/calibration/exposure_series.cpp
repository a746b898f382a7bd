// Exposures from EXIF or the command line, checked before anything is made of the photographs.
#include "calibration/exposure_series.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/memory.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using Paths = std::vector<fs::path>;

/// Exposures closer than this are the same: a hundredth of a stop is less than any camera's steps.
constexpr double same_exposure_ev = 0.01;

/// What a pixel of a photograph takes while a series is merged: three floats, a mask, and a share of the result.
constexpr std::uint64_t bytes_per_pixel = 24;

void check_count(const std::vector<double>& values, std::size_t photographs, bool one_for_all, const char* what,
                 const char* option) {
    if (values.empty() || values.size() == photographs || (one_for_all && values.size() == 1)) return;
    throw InputError({}, fmt::format("{} {} for {} photographs", values.size(), what, photographs),
                     fmt::format("give {} one for each photograph, in the same order{}", option,
                                 one_for_all ? ", or one for all" : ""));
}

double chosen(const std::vector<double>& given, std::size_t i, double recorded) {
    return given.empty() ? recorded : given[given.size() == 1 ? 0 : i];
}

void check_given_twice(const Paths& photographs) {
    for (std::size_t i = 0; i < photographs.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            std::error_code error;
            if (photographs[i] == photographs[j] || fs::equivalent(photographs[i], photographs[j], error))
                throw InputError(photographs[i], "is given twice", "name each photograph once");
        }
    }
}

void check_positive(const fs::path& path, double value, const char* what, const char* option) {
    if (std::isfinite(value) && value > 0) return;
    throw InputError(path, fmt::format("its {} is {}", what, value),
                     fmt::format("give positive numbers with {}", option));
}

/// What of the exposure is known for some photographs only: harmless where those that know it agree.
void fill_missing(std::vector<Photograph>& shots, double ExposureRecord::*value, const char* what, const char* option,
                  Warnings& warnings) {
    const auto known = [&](const Photograph& shot) { return shot.record.*value > 0; };
    const auto first = std::find_if(shots.begin(), shots.end(), known);
    const auto without = std::find_if_not(shots.begin(), shots.end(), known);
    if (first == shots.end() || without == shots.end()) return;
    const double common = (*first).record.*value;
    for (const Photograph& shot : shots) {
        if (known(shot) && shot.record.*value != common) {
            throw InputError(without->path, fmt::format("does not say its {}, which differs between the others", what),
                             fmt::format("give it with {}", option));
        }
    }
    for (Photograph& shot : shots) {
        if (known(shot)) continue;
        warnings.add(fmt::format("{}: does not say its {}; that of the others, {:g}, is assumed", shot.path.string(),
                                 what, common));
        shot.record.*value = common;
    }
}

void check_memory(const Photograph& first, std::size_t photographs) {
    const std::uint64_t needed = static_cast<std::uint64_t>(first.code.width()) *
                                 static_cast<std::uint64_t>(first.code.height()) * photographs * bytes_per_pixel;
    if (needed > available_memory_bytes()) {
        throw InputError(
            first.path,
            fmt::format("{} photographs of {} × {} pixels need {:.1f} GB of memory, more than there is", photographs,
                        first.code.width(), first.code.height(), static_cast<double>(needed) / 1e9),
            "give fewer or smaller ones");
    }
}

void check_like_first(const Photograph& shot, const Photograph& first) {
    if (shot.code.bounds() != first.code.bounds()) {
        throw InputError(shot.path,
                         fmt::format("{} × {} pixels, but {} has {} × {}", shot.code.width(), shot.code.height(),
                                     first.path.filename().string(), first.code.width(), first.code.height()),
                         "give photographs of one size");
    }
    if (shot.linear != first.linear) {
        throw InputError(shot.path, "a series cannot hold raw files beside developed ones", "give one kind");
    }
}

double exposure_of(const ExposureRecord& record) {
    const double per_aperture = record.f_number > 0 ? 1 / (record.f_number * record.f_number) : 1;
    const double per_iso = record.iso > 0 ? record.iso / 100 : 1;
    return record.exposure_s * per_iso * per_aperture;
}

void check_exposures(const std::vector<Photograph>& shots, Warnings& warnings) {
    if (shots.size() == 1) {
        warnings.add(shots.front().path.string() + ": one photograph alone: what it clips stays clipped");
        return;
    }
    const double range_ev = std::log2(shots.front().exposure / shots.back().exposure);
    if (range_ev < same_exposure_ev) {
        throw InputError(shots.front().path, fmt::format("all {} photographs have the same exposure", shots.size()),
                         "give photographs of different exposures, or their true times with --times");
    }
}

}  // namespace

double seconds_from_text(const std::string& text) {
    const auto number = [](std::string_view part, double& value) {
        const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
        return error == std::errc() && end == part.data() + part.size();
    };
    const std::size_t slash = text.find('/');
    double value = 0, divisor = 1;
    const bool read = slash == std::string::npos ? number(text, value)
                                                 : number(std::string_view(text).substr(0, slash), value) &&
                                                       number(std::string_view(text).substr(slash + 1), divisor);
    if (!read || !std::isfinite(value / divisor) || !(value / divisor > 0))
        throw InputError({}, fmt::format("'{}' is no exposure time", text), "write seconds, such as 1/30 or 0.5");
    return value / divisor;
}

ExposureSeries read_exposure_series(const Paths& photographs, const ExposureOptions& given, Warnings& warnings) {
    const std::size_t count = photographs.size();
    if (count == 0) throw InputError({}, "no photographs are given");
    check_count(given.times_s, count, false, "exposure times", "--times");
    check_count(given.f_numbers, count, true, "f-numbers", "--f-numbers");
    check_count(given.isos, count, true, "ISO values", "--iso");
    check_given_twice(photographs);

    ExposureSeries series;
    for (std::size_t i = 0; i < count; ++i) {
        const fs::path& path = photographs[i];
        PhotographFile file = read_photograph(path);
        Photograph shot;
        shot.path = path;
        shot.record.exposure_s = chosen(given.times_s, i, file.exposure.exposure_s);
        shot.record.f_number = chosen(given.f_numbers, i, file.exposure.f_number);
        shot.record.iso = chosen(given.isos, i, file.exposure.iso);
        shot.code = std::move(file.code);
        shot.linear = file.linear;
        shot.code_step = file.code_step;
        shot.subsampled = file.subsampled;
        if (given.times_s.empty() && shot.record.exposure_s == 0)
            throw InputError(path, "its EXIF data has no exposure time", "give the times with --times");
        check_positive(path, shot.record.exposure_s, "exposure time", "--times");
        if (!given.f_numbers.empty()) check_positive(path, shot.record.f_number, "f-number", "--f-numbers");
        if (!given.isos.empty()) check_positive(path, shot.record.iso, "ISO value", "--iso");
        if (i == 0) check_memory(shot, count);
        series.shots.push_back(std::move(shot));
        check_like_first(series.shots.back(), series.shots.front());
    }
    fill_missing(series.shots, &ExposureRecord::f_number, "f-number", "--f-numbers", warnings);
    fill_missing(series.shots, &ExposureRecord::iso, "ISO value", "--iso", warnings);
    for (Photograph& shot : series.shots) shot.exposure = exposure_of(shot.record);
    std::stable_sort(series.shots.begin(), series.shots.end(),
                     [](const Photograph& a, const Photograph& b) { return a.exposure > b.exposure; });
    check_exposures(series.shots, warnings);
    return series;
}

}  // namespace matchlight
