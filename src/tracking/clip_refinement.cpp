// Shared unknowns from a spread of frames, then every pose.
#include "tracking/clip_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <Eigen/Cholesky>

#include "core/median.h"
#include "core/parallel.h"
#include "tracking/bundle.h"
#include "tracking/lens_freedom.h"
#include "tracking/lens_start.h"
#include "tracking/path_refinement.h"
#include "tracking/shared_normal.h"
#include "tracking/sheet_evidence.h"

namespace matchlight {

namespace {

class Refinement {
public:
    Refinement(const ClipContext& context, const std::vector<FrameObservations>& clip, GeometrySolution& geometry)
        : context_(context), clip_(clip), geometry_(geometry), calibrated_(!context.scene.footage.camera.empty()) {
        model_.camera = geometry.camera;
        take_tags();
        take_frames();
        freedom_.prior = calibrated_ ? calibration_prior(geometry.camera) : uncalibrated_prior(geometry.camera);
        freedom_.lens.fill(!calibrated_);
        const FootageSettings& footage = context.scene.footage;
        model_.readout_s = footage.readout_s;
        if (footage.readout_s > 0) set_velocities(geometry.path, frames_);
    }

    void run() {
        const std::vector<std::size_t> chosen = spread_frames();
        if (chosen.empty()) return;
        // Where the search for the noise begins: what a fit of pixels usually leaves.
        freedom_.noise_floor_px = 0.02;
        freedom_.corner_bias_px = 0.05;
        std::vector<BundleFrame> frames = taken(chosen);
        if (!adjust_bundle(model_, freedom_, frames).usable) return;
        estimate_noise(frames);
        if (calibrated_) choose_lens(frames);
        if (!adjust_bundle(model_, freedom_, frames).usable) return;
        put_back(chosen, frames);
        if (context_.scene.footage.solve_readout) frames = solve_readout(chosen, std::move(frames));

        const SharedColumns columns(model_, freedom_);
        const Eigen::MatrixXd covariance = shared_covariance(columns, frames);
        geometry_.camera = model_.camera;
        tell_lens(columns, covariance);
        for (const auto& [id, tag] : model_.tags) geometry_.rig.world_from_tag[id] = tag.world_from_tag;
        geometry_.leave_one_out_px = leave_one_out_px(model_, freedom_, frames);
        refine_path({model_, freedom_, columns, covariance}, frames_, geometry_.path);
    }

private:
    void take_tags() {
        for (const RigTag& tag : context_.scene.tags.rig) {
            const auto place = geometry_.rig.world_from_tag.find(tag.id);
            if (place == geometry_.rig.world_from_tag.end()) continue;
            ModelTag& known = model_.tags[tag.id];
            known.size_m = tag.size_m;
            known.world_from_tag = place->second;
            known.held = tag.world_from_tag || geometry_.rig.origin == tag.id;
        }
    }

    void take_frames() {
        std::map<int, std::vector<double>> sides_px;
        for (std::size_t f = 0; f < clip_.size(); ++f) {
            const PathFrame& found = geometry_.path.frames[f];
            BundleFrame& frame = frames_.emplace_back();
            if (!found.pose || found.bridged) continue;
            frame.camera_from_world = found.pose->camera_from_world;
            for (const std::size_t i : found.sightings) {
                const TagObservation& seen = clip_[f].tags[i];
                frame.views.push_back(bundle_view(seen, geometry_.camera));
                sides_px[seen.id].push_back(seen.side_px);
            }
        }
        std::erase_if(model_.tags, [&](const auto& tag) { return !sides_px.contains(tag.first); });
        for (auto& [id, tag] : model_.tags) tag.metres_per_px = tag.size_m / upper_median(sides_px.at(id));
    }

    /// Frames that know what all share: a few hundred determine it many times over; more cost time and change little.
    /// Of every pair of tags that is ever seen together there are some.
    std::vector<std::size_t> spread_frames() const {
        constexpr std::size_t most = 300, of_a_pair = 8;
        std::vector<std::size_t> seeing;
        std::map<std::pair<int, int>, std::vector<std::size_t>> together;
        for (std::size_t f = 0; f < frames_.size(); ++f) {
            const std::vector<BundleView>& views = frames_[f].views;
            if (!views.empty()) seeing.push_back(f);
            for (std::size_t i = 0; i < views.size(); ++i) {
                for (std::size_t j = i; j < views.size(); ++j) {
                    together[{views[i].seen->id, views[j].seen->id}].push_back(f);
                }
            }
        }
        std::set<std::size_t> chosen;
        const auto spread = [&](const std::vector<std::size_t>& from, std::size_t count) {
            for (std::size_t i = 0; i < std::min(count, from.size()); ++i) {
                chosen.insert(from[i * from.size() / std::min(count, from.size())]);
            }
        };
        spread(seeing, most);
        for (const auto& [pair, list] : together) spread(list, of_a_pair);
        return {chosen.begin(), chosen.end()};
    }

    std::vector<BundleFrame> taken(const std::vector<std::size_t>& chosen) const {
        std::vector<BundleFrame> frames;
        for (const std::size_t f : chosen) frames.push_back(frames_[f]);
        return frames;
    }

    void put_back(const std::vector<std::size_t>& chosen, const std::vector<BundleFrame>& frames) {
        for (std::size_t i = 0; i < chosen.size(); ++i) frames_[chosen[i]] = frames[i];
    }

    /// How much noise the fits did not state, and what does not average out over the clip.
    void estimate_noise(std::vector<BundleFrame>& chosen) {
        constexpr int rounds = 2;  // each starts from poses and places that the one before made better
        for (int round = 0; round < rounds; ++round) {
            estimate_floor(chosen);
            ModelFreedom wide = freedom_;
            wide.plane_sigma_m = 1;
            if (round == 0) model_.world_from_plane = likely_plane(model_);
            const SharedColumns columns(model_, wide);
            choose_sheet_evidence(normal_of_frames(model_, wide, columns, chosen), columns, model_, freedom_);
            adjust_bundle(model_, freedom_, chosen);
        }
    }

    /// The noise at which half of the frames have larger residuals than expected.
    void estimate_floor(const std::vector<BundleFrame>& chosen) {
        std::vector<double> ratios, stated_px2;
        const SharedColumns none;
        for (const BundleFrame& frame : chosen) {
            const FrameNormal normal = frame_normal(model_, freedom_, none, frame);
            const double spare = normal.effective_count - 6;
            if (!normal.in_front || !(spare > 1)) continue;
            // A χ²'s median lies below its mean (Wilson & Hilferty 1931).
            const double median_of_mean = std::pow(1 - 2 / (9 * spare), 3);
            ratios.push_back(normal.squares / (spare * median_of_mean));
            for (const BundleView& view : frame.views) stated_px2.push_back(view.covariance_px.trace() / 8);
        }
        if (ratios.empty()) return;
        const double stated = upper_median(stated_px2);
        const double taken =
            freedom_.noise_scale * freedom_.noise_scale * stated + freedom_.noise_floor_px * freedom_.noise_floor_px;
        const double needed = upper_median(ratios) * taken;
        // Coding alone leaves a few thousandths of a pixel from frame to frame. Corners that hold still better than
        // they are stated to would otherwise be smoothed more than the motion allows.
        constexpr double least_px = 0.005, least_scale = 0.05;
        freedom_.noise_floor_px = std::sqrt(std::max(needed - stated, least_px * least_px));
        const double floor_px2 = freedom_.noise_floor_px * freedom_.noise_floor_px;
        freedom_.noise_scale = std::clamp(std::sqrt(std::max(0.0, needed - floor_px2) / stated), least_scale, 1.0);
    }

    void choose_lens(const std::vector<BundleFrame>& chosen) {
        const LensRefinement asked = context_.scene.footage.refine_lens;
        if (asked != LensRefinement::automatic) {
            freedom_.lens.fill(asked == LensRefinement::on);
            return;
        }
        ModelFreedom open = freedom_;
        open.lens.fill(true);
        const SharedColumns columns(model_, open);
        constexpr std::size_t stretches = 8;  // long enough to be independent, many enough to leave most for the rest
        std::vector<SharedNormal> blocks;
        for (std::size_t q = 0; q < stretches; ++q) {
            const std::size_t begin = q * chosen.size() / stretches, end = (q + 1) * chosen.size() / stretches;
            blocks.push_back(normal_of_frames(model_, open, columns, std::span(chosen).subspan(begin, end - begin)));
        }
        freedom_.lens = choose_lens_freedom(blocks, columns, model_, open);
    }

    /// The read-out time from rows that saw the rig at different times. Given up where the camera moves too little.
    std::vector<BundleFrame> solve_readout(const std::vector<std::size_t>& chosen, std::vector<BundleFrame> frames) {
        freedom_.readout = true;
        double sigma_s = freedom_.readout_sigma_s;
        constexpr int rounds = 3;  // poses, hence velocities, depend on the read-out
        for (int round = 0; round < rounds; ++round) {
            const SharedColumns columns(model_, freedom_);
            parallel_for(static_cast<int>(frames_.size()), [&](int f) {
                BundleFrame& frame = frames_[static_cast<std::size_t>(f)];
                if (!frame.views.empty()) refine_frame(model_, freedom_, columns, frame);
            });
            set_velocities(geometry_.path, frames_);
            frames = taken(chosen);
            adjust_bundle(model_, freedom_, frames);
            put_back(chosen, frames);
            sigma_s = std::sqrt(shared_covariance(columns, frames)(columns.readout, columns.readout));
        }
        geometry_.readout_sigma_s = sigma_s;
        // Sensors differ between 5 and 30 ms: less than that must be known to tell one from none.
        constexpr double useful_s = 0.004;
        if (sigma_s > useful_s) {
            freedom_.readout = false;
            model_.readout_s = 0;
            adjust_bundle(model_, freedom_, frames);
            put_back(chosen, frames);
        } else {
            geometry_.readout_s = model_.readout_s;
        }
        return frames;
    }

    Eigen::MatrixXd shared_covariance(const SharedColumns& columns, const std::vector<BundleFrame>& frames) const {
        SharedNormal shared = prior_normal(model_, freedom_, columns);
        shared += normal_of_frames(model_, freedom_, columns, frames);
        const Eigen::VectorXd scale = shared.information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd inverse = (scale.asDiagonal() * shared.information * scale.asDiagonal())
                                            .ldlt()
                                            .solve(Eigen::MatrixXd::Identity(columns.count, columns.count));
        return scale.asDiagonal() * inverse * scale.asDiagonal();
    }

    /// What is known of the lens: of refined parameters by the clip, of the others by their calibration.
    void tell_lens(const SharedColumns& columns, const Eigen::MatrixXd& covariance) {
        geometry_.lens_parameters.clear();
        for (std::size_t i = 0; i < columns.lens.size(); ++i) {
            const int column = columns.lens[i];
            if (column >= 0) {
                geometry_.lens_parameters.push_back(
                    {lens_parameter_names[i], std::sqrt(std::max(0.0, covariance(column, column))), true});
            } else if (context_.camera.sigmas) {
                const double sigma = freedom_.prior.sigma[static_cast<Eigen::Index>(i)];
                geometry_.lens_parameters.push_back({lens_parameter_names[i], sigma, false});
            }
        }
    }

    const ClipContext& context_;
    const std::vector<FrameObservations>& clip_;
    GeometrySolution& geometry_;
    bool calibrated_;
    ClipModel model_;
    ModelFreedom freedom_;
    std::vector<BundleFrame> frames_;  // parallel to the clip's
};

}  // namespace

void refine_geometry(const ClipContext& context, const std::vector<FrameObservations>& frames,
                     GeometrySolution& geometry) {
    Refinement(context, frames, geometry).run();
}

}  // namespace matchlight
