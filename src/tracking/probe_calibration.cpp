// The solve's exposures give the scale; what single tags make of it tells how far it can be trusted.
#include "tracking/probe_calibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "calibration/tag_family.h"
#include "core/median.h"
#include "tracking/probe_card.h"

namespace matchlight {
namespace {

/// Light on a tag that the probe itself shows is good to some 2 %, an assumed albedo under a light assumed even over
/// the tags to 5 % (photometry.cpp weighs them alike).
constexpr double shown_sigma = 0.02;
constexpr double assumed_sigma = 0.05;

double ev(double natural_log) {
    return natural_log / std::log(2.0);
}

double median(const std::vector<double>& values) {
    return upper_median(std::vector<double>(values));
}

/// What tag readings say beyond the solve: log2 of reading over expectation, frame exposure and fall-off taken out.
struct TagResiduals {
    std::array<std::vector<double>, 3> ev;
    std::vector<double> reading_sigma;  // relative
};

std::map<int, TagResiduals> residuals_of(const Solve& solve, const TrackDetails& details) {
    std::map<int, TagResiduals> residuals;
    for (std::size_t i = 0; i < details.cards.size(); ++i) {
        const SolvedFrame* frame = solve.find(details.observations[i].frame);
        if (frame == nullptr || !frame->exposure_ev || !frame->white_balance) continue;
        for (const CardReading& card : details.cards[i]) {
            const auto expected = details.expected_cards.find(card.id);
            if (expected == details.expected_cards.end()) continue;
            const auto& light =
                expected->second.shown_difference ? *expected->second.shown_difference : expected->second.difference;
            const double r2 = card.radius * card.radius;
            const double fall_off = solve.vignette ? 1 + (*solve.vignette)[0] * r2 + (*solve.vignette)[1] * r2 * r2 : 1;
            TagResiduals& tag = residuals[card.id];
            for (std::size_t c = 0; c < 3; ++c) {
                if (!card.difference[c].usable || !(light[c] > 0)) continue;
                tag.ev[c].push_back(std::log2(card.difference[c].light / (light[c] * fall_off)) - *frame->exposure_ev -
                                    std::log2((*frame->white_balance)[c]));
                tag.reading_sigma.push_back(card.difference[c].relative_error);
            }
        }
    }
    return residuals;
}

CalibratedTag judged(int id, const TagResiduals& residuals, bool shown) {
    CalibratedTag tag;
    tag.id = id;
    tag.shown_in_probe = shown;
    int channels = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<double>& values = residuals.ev[c];
        tag.deviation_ev[c] = 0;
        if (values.empty()) continue;
        tag.frames = std::max(tag.frames, static_cast<std::int64_t>(values.size()));
        tag.deviation_ev[c] = median(values);
        double square = 0;
        for (const double value : values) square += (value - tag.deviation_ev[c]) * (value - tag.deviation_ev[c]);
        tag.scatter_ev += std::sqrt(square / static_cast<double>(values.size()));
        tag.mean_deviation_ev += tag.deviation_ev[c];
        ++channels;
    }
    tag.mean_deviation_ev /= channels;
    tag.scatter_ev /= channels;
    const double card = shown ? shown_sigma : assumed_sigma;
    const double reading = median(residuals.reading_sigma) / std::sqrt(static_cast<double>(tag.frames));
    tag.sigma_ev = ev(std::hypot(card, reading));
    tag.out_of_line = std::any_of(tag.deviation_ev.begin(), tag.deviation_ev.end(),
                                  [&](double deviation) { return std::abs(deviation) > 3 * tag.sigma_ev; });
    return tag;
}

/// Standard error of the scale: from how tags disagree, and never better than one of them could be.
double sigma_of_channel(const std::vector<CalibratedTag>& tags, std::size_t channel) {
    double least = tags.front().sigma_ev;
    double square = 0;
    for (const CalibratedTag& tag : tags) {
        least = std::min(least, tag.sigma_ev);
        square += tag.deviation_ev[channel] * tag.deviation_ev[channel];
    }
    const auto count = static_cast<double>(tags.size());
    const double scatter = tags.size() > 1 ? std::sqrt(square / (count * (count - 1))) : 0;
    return std::max(scatter, least / std::sqrt(count));
}

}  // namespace

std::optional<ProbeCalibration> calibrate_probe(const Solve& solve, const TrackDetails& details,
                                                std::optional<std::int64_t> frame) {
    ProbeCalibration calibration;
    std::vector<double> exposures;
    std::array<std::vector<double>, 3> balances;
    for (std::size_t i = 0; i < details.cards.size(); ++i) {
        const SolvedFrame* solved = solve.find(details.observations[i].frame);
        if (details.cards[i].empty() || solved == nullptr || !solved->exposure_ev || !solved->white_balance) continue;
        if (calibration.frames == 0) calibration.least_ev = calibration.most_ev = *solved->exposure_ev;
        ++calibration.frames;
        calibration.least_ev = std::min(calibration.least_ev, *solved->exposure_ev);
        calibration.most_ev = std::max(calibration.most_ev, *solved->exposure_ev);
        if (frame && solved->frame != *frame) continue;
        exposures.push_back(*solved->exposure_ev);
        for (std::size_t c = 0; c < 3; ++c) balances[c].push_back((*solved->white_balance)[c]);
    }
    if (exposures.empty()) return std::nullopt;
    calibration.exposure_ev = median(exposures);
    for (std::size_t c = 0; c < 3; ++c) {
        calibration.white_balance[c] = median(balances[c]);
        calibration.channel_ev[c] = calibration.exposure_ev + std::log2(calibration.white_balance[c]);
    }
    for (const auto& [id, residuals] : residuals_of(solve, details)) {
        if (residuals.reading_sigma.empty()) continue;
        calibration.tags.push_back(judged(id, residuals, details.expected_cards.at(id).shown_difference.has_value()));
    }
    if (calibration.tags.empty()) return std::nullopt;
    for (std::size_t c = 0; c < 3; ++c) calibration.channel_sigma[c] = sigma_of_channel(calibration.tags, c);
    return calibration;
}

std::optional<ProbeTurn> better_turn(const Scene& scene, const Probe& probe, const TrackDetails& details) {
    if (!scene.probe || !scene.probe->place_m) return std::nullopt;
    const Eigen::Vector3d probe_place_m = *scene.probe->place_m;
    const TagFamily family(scene.tags.family);
    const auto tags_shown = [&](double turn_deg) {
        // Light turned one way sees the world turned the other.
        const Eigen::AngleAxisd back(-turn_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ());
        int shown = 0;
        for (const RigTag& tag : scene.tags.rig) {
            const auto place = details.world_from_tag.find(tag.id);
            if (place == details.world_from_tag.end()) continue;
            RigidTransform turned = place->second;
            turned.translation() = back * (place->second.translation() - probe_place_m) + probe_place_m;
            turned.linear() = back * place->second.linear();
            shown += card_in_probe(probe, probe_place_m, family.pattern(tag.id), {tag.size_m, turned}).has_value();
        }
        return shown;
    };
    // Half a cell of a tag that fills 40° of the probe with its eight cells is 2.5°.
    constexpr int step_deg = 1;
    ProbeTurn best{0, tags_shown(0)};
    const int as_it_stands = best.tags_shown;
    int first = 0, last = 0;
    for (int turn = step_deg; turn < 360; turn += step_deg) {
        const int shown = tags_shown(turn);
        if (shown > best.tags_shown) {
            best.tags_shown = shown;
            first = turn;
        }
        // The middle of the first run of turns that show so many.
        if (shown == best.tags_shown && shown > as_it_stands && (last == turn - step_deg || first == turn)) last = turn;
    }
    if (best.tags_shown == as_it_stands) return std::nullopt;
    best.turn_deg = (first + last) / 2.0;
    return best;
}

}  // namespace matchlight
