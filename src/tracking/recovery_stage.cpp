// Which frames to look at again, and the looks.
#include "tracking/recovery_stage.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "calibration/tag_family.h"
#include "core/error.h"
#include "core/median.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/stop.h"
#include "tracking/plate_light.h"
#include "tracking/rig_image_fit.h"
#include "tracking/tag_fit.h"

namespace matchlight {

namespace {

constexpr double least_side_px = 15;
constexpr double poor_correlation = 0.9;
/// Of an unknown shutter: half of the frame's time is the rule of film and the usual setting of video.
constexpr double likely_shutter = 0.5;
/// A box of this length has the standard deviation of two pixels' blur: from here on its shape shows beside the lens'.
constexpr double smeared_px = 7;

/// A frame to look at again.
struct Look {
    std::size_t index = 0;  // in ClipObservations::frames
    bool smeared = false;
    std::vector<const PlacedSheet*> missing;  // should be seen, and are not, or poorly
};

/// Where a sheet should be in the picture.
struct ExpectedSheet {
    TagCorners corners_px;
    double side_px = 0;
    double inside = 0;  // share of its area that the picture holds
};

std::optional<ExpectedSheet> expected_sheet(const PlacedSheet& sheet, const RigidTransform& camera_from_world,
                                            const Camera& camera) {
    const RigidTransform camera_from_tag = camera_from_world * sheet.world_from_tag;
    const Eigen::Matrix<double, 3, 4> corners = camera_from_tag * tag_corners_m(sheet.size_m);
    const Eigen::Vector3d centre = camera_from_tag.translation();
    constexpr double nearest_m = 1e-3;
    constexpr double grazing = 0.1;  // cosine: beyond 84° nothing of the cells is seen
    if (corners.row(2).minCoeff() < nearest_m || -camera_from_tag.linear().col(2).dot(centre.normalized()) < grazing) {
        return std::nullopt;
    }
    ExpectedSheet expected;
    for (int i = 0; i < 4; ++i) expected.corners_px.col(i) = camera.pixel_from_camera(corners.col(i));
    if (!expected.corners_px.allFinite()) return std::nullopt;
    for (int i = 0; i < 4; ++i) {
        expected.side_px += (expected.corners_px.col(i) - expected.corners_px.col((i + 1) % 4)).norm() / 4;
    }
    int inside = 0;
    constexpr int lattice = 8;
    for (int row = 0; row < lattice; ++row) {
        for (int column = 0; column < lattice; ++column) {
            const double u = (column + 0.5) / lattice - 0.5, v = (row + 0.5) / lattice - 0.5;
            const Eigen::Vector3d point = camera_from_tag * Eigen::Vector3d(u * sheet.size_m, v * sheet.size_m, 0);
            const Eigen::Vector2d px = camera.pixel_from_camera(point);
            inside += px.x() > 0 && px.y() > 0 && px.x() < camera.width - 1 && px.y() < camera.height - 1;
        }
    }
    expected.inside = static_cast<double>(inside) / (lattice * lattice);
    return expected;
}

bool should_be_seen(const std::optional<ExpectedSheet>& expected) {
    return expected && expected->side_px > least_side_px && expected->inside >= 0.5;
}

class Recovery {
public:
    Recovery(const ClipContext& context, const GeometrySolution& geometry, ClipObservations& clip)
        : context_(context),
          geometry_(geometry),
          clip_(clip),
          plate_light_(context.response, context.footage.format.transfer),
          lens_(context.camera),
          solved_lens_(geometry.camera) {
        const TagFamily family(context.scene.tags.family);
        for (const RigTag& tag : context.scene.tags.rig) {
            const auto place = geometry.rig.world_from_tag.find(tag.id);
            if (place == geometry.rig.world_from_tag.end()) continue;
            sheets_.push_back({tag.id, tag.size_m, place->second, family.pattern(tag.id)});
        }
        for (const PathFrame& frame : geometry.path.frames) {
            poses_.push_back(frame.pose ? std::optional(frame.pose->camera_from_world) : std::nullopt);
        }
    }

    std::int64_t run(FrameSource& source) {
        const std::vector<Look> looks = choose();
        if (looks.empty()) return 0;
        Progress progress("find tags again", static_cast<std::int64_t>(looks.size()), context_.options.quiet);
        std::int64_t next_frame = -1;
        constexpr std::size_t batch_length = 8;  // pictures in memory at a time
        for (std::size_t begin = 0; begin < looks.size(); begin += batch_length) {
            const std::size_t end = std::min(looks.size(), begin + batch_length);
            std::vector<PlateFrame> frames;
            std::vector<Look> batch;
            for (std::size_t i = begin; i < end; ++i) {
                const std::int64_t wanted = clip_.frames[looks[i].index].frame;
                std::optional<PlateFrame> frame = decode(source, wanted, next_frame);
                if (!frame) continue;
                frames.push_back(std::move(*frame));
                batch.push_back(looks[i]);
            }
            std::vector<std::optional<Found>> found(batch.size());
            parallel_for(static_cast<int>(batch.size()), [&](int i) {
                const auto at = static_cast<std::size_t>(i);
                if (poses_[batch[at].index]) found[at] = look(batch[at], frames[at]);
            });
            for (std::size_t i = 0; i < batch.size(); ++i) {
                // Beyond the reach of the path: from the pose before, which may have just been found.
                if (!poses_[batch[i].index]) {
                    poses_[batch[i].index] = continued(batch[i].index);
                    if (poses_[batch[i].index]) found[i] = look(batch[i], frames[i]);
                    if (!found[i]) poses_[batch[i].index].reset();
                }
                if (found[i]) take(batch[i].index, *found[i]);
                progress.advance();
            }
        }
        take_joint_fits();
        return added_;
    }

private:
    struct Found {
        std::vector<TagObservation> tags;
        RigidTransform camera_from_world = RigidTransform::Identity();
        std::optional<RigImageFit> joint;  // then the tags follow from it
    };

    /// The frame `wanted`; `next_frame` is where the decoder stands, −1 before the first.
    std::optional<PlateFrame> decode(FrameSource& source, std::int64_t wanted, std::int64_t& next_frame) const {
        constexpr std::int64_t nearer_than_a_seek = 24;  // to the key frame before, as a rule
        if (next_frame < 0 || wanted < next_frame || wanted > next_frame + nearer_than_a_seek) source.seek(wanted);
        while (true) {
            if (stop_requested()) throw InputError(source.info().path, "stopped on request");
            std::optional<PlateFrame> frame = source.next();
            if (!frame || frame->index() > wanted) {  // damaged, or the end
                next_frame = -1;
                return std::nullopt;
            }
            next_frame = frame->index() + 1;
            if (frame->index() == wanted) return frame;
        }
    }

    /// Perturbation from this frame to the next, by its neighbours.
    PoseStep velocity(std::size_t index) const {
        const auto pose = [&](std::size_t i) -> const RigidTransform* {
            return i < poses_.size() && poses_[i] ? &*poses_[i] : nullptr;
        };
        const RigidTransform* here = pose(index);
        const RigidTransform* before = index > 0 ? pose(index - 1) : nullptr;
        const RigidTransform* after = pose(index + 1);
        if (before && after) return 0.5 * perturbation_between(*before, *after);
        if (here && after) return perturbation_between(*here, *after);
        if (before && here) return perturbation_between(*before, *here);
        return PoseStep::Zero();
    }

    /// The longer of the ways to the frame before and the frame after: where the camera turns back, their mean is none.
    PoseStep fastest(std::size_t index) const {
        PoseStep fastest = velocity(index);
        if (!poses_[index]) return fastest;
        for (const std::size_t other : {index - 1, index + 1}) {  // wraps round at 0: none such
            if (other >= poses_.size() || !poses_[other]) continue;
            const PoseStep way = perturbation_between(*poses_[index], *poses_[other]);
            if (way.head<3>().norm() > fastest.head<3>().norm()) fastest = way;
        }
        return fastest;
    }

    std::optional<RigidTransform> continued(std::size_t index) const {
        if (index == 0 || !poses_[index - 1]) return std::nullopt;
        if (index == 1 || !poses_[index - 2]) return poses_[index - 1];
        return perturbed(*poses_[index - 1], perturbation_between(*poses_[index - 2], *poses_[index - 1]));
    }

    MovingCamera start_at(std::size_t index) const { return {*poses_[index], likely_shutter * velocity(index), 1}; }

    std::vector<Look> choose() const {
        std::vector<Look> looks;
        for (std::size_t f = 0; f < clip_.frames.size(); ++f) {
            Look look;
            look.index = f;
            if (!poses_[f]) {
                looks.push_back(look);
                continue;
            }
            fill(look);
            const bool wanted = context_.options.level == TrackLevel::fast ? clip_.frames[f].tags.empty()
                                                                           : look.smeared || !look.missing.empty();
            if (wanted) looks.push_back(look);
        }
        return looks;
    }

    void fill(Look& look) const {
        const MovingCamera start{*poses_[look.index], likely_shutter * fastest(look.index), 1};
        double most_streak_px = 0;
        for (const PlacedSheet& sheet : sheets_) {
            const std::optional<ExpectedSheet> expected =
                expected_sheet(sheet, start.camera_from_world, geometry_.camera);
            if (!should_be_seen(expected)) continue;
            most_streak_px = std::max(most_streak_px, SheetImage(sheet, start, geometry_.camera).streak_px());
            const auto& tags = clip_.frames[look.index].tags;
            const auto seen = std::ranges::find(tags, sheet.id, &TagObservation::id);
            if (seen == tags.end() || !seen->refined || seen->correlation < poor_correlation) {
                look.missing.push_back(&sheet);
            }
        }
        look.smeared = most_streak_px > smeared_px;
    }

    /// How far off the pose of a frame may be in the picture, by its covariance.
    double error_px(std::size_t index) const {
        const PathFrame& frame = geometry_.path.frames[index];
        constexpr double least_px = 3, followed_px = 12, most_share_of_width = 0.06;
        if (!frame.pose) return followed_px;
        double most_px = least_px;
        for (const PlacedSheet& sheet : sheets_) {
            const Eigen::Vector3d world = sheet.world_from_tag.translation();
            const Eigen::Vector3d point = frame.pose->camera_from_world * world;
            if (!(point.z() > 1e-3)) continue;
            Eigen::Matrix<double, 2, 3> by_point;
            by_point << 1, 0, -point.x() / point.z(), 0, 1, -point.y() / point.z();
            by_point *= geometry_.camera.fx / point.z();
            Eigen::Matrix3d cross;
            cross << 0, -world.z(), world.y(), world.z(), 0, -world.x(), -world.y(), world.x(), 0;
            Eigen::Matrix<double, 2, 6> jacobian;
            const Eigen::Matrix<double, 2, 3> by_world = by_point * frame.pose->camera_from_world.linear();
            jacobian << -by_world * cross, by_world;
            const double sigma = std::sqrt((jacobian * frame.pose->covariance * jacobian.transpose()).trace());
            if (std::isfinite(sigma)) most_px = std::max(most_px, 3 * sigma);
        }
        return std::min(most_px, most_share_of_width * geometry_.camera.width);
    }

    std::optional<Found> look(Look look, const PlateFrame& frame) const {
        if (look.missing.empty() && !look.smeared) fill(look);
        const ImageF light = plate_light_.gray(frame, {0, 0, frame.format().width, frame.format().height});
        if (look.smeared) return look_for_rig(look.index, light);
        std::optional<Found> found = look_for_each(look, light);
        if (!found && clip_.frames[look.index].tags.empty()) found = look_for_rig(look.index, light);
        return found;
    }

    std::optional<Found> look_for_each(const Look& look, const ImageF& light) const {
        const FitSource source{light, 0, 0, lens_, plate_light_.clipped_light(1)};
        const auto& seen = clip_.frames[look.index].tags;
        Found found;
        std::vector<PlacedObservation> placed;
        for (const PlacedSheet* sheet : look.missing) {
            const std::optional<ExpectedSheet> expected = expected_sheet(*sheet, *poses_[look.index], geometry_.camera);
            TagDetection detection;
            detection.id = sheet->id;
            for (int i = 0; i < 4; ++i) {
                detection.corners_px[static_cast<std::size_t>(i)] = expected->corners_px.col(i);
            }
            TagFitOptions options;
            options.start_error_px = error_px(look.index);
            const std::optional<TagImageFit> fit = fit_tag(source, sheet->printed, detection, options);
            if (!fit || !fit->observation.refined || fit->observation.correlation < poor_correlation) continue;
            // One that was seen before is replaced only by a better fit.
            const auto before = std::ranges::find(seen, sheet->id, &TagObservation::id);
            if (before != seen.end() && before->refined && before->correlation >= fit->observation.correlation) {
                continue;
            }
            found.tags.push_back(fit->observation);
        }
        if (found.tags.empty()) return std::nullopt;
        for (const TagObservation& tag : found.tags) {
            const auto sheet = std::ranges::find(sheets_, tag.id, &PlacedSheet::id);
            placed.push_back({&tag, sheet->size_m, sheet->world_from_tag});
        }
        const std::optional<CameraPose> pose = refine_pose(placed, *poses_[look.index]);
        if (!pose) return std::nullopt;
        found.camera_from_world = pose->camera_from_world;
        return found;
    }

    std::optional<Found> look_for_rig(std::size_t index, const ImageF& light) const {
        const FitSource source{light, 0, 0, solved_lens_, plate_light_.clipped_light(1)};
        RigFitOptions options;
        options.search_px = error_px(index);
        const std::optional<RigImageFit> fit = fit_rig_image(source, sheets_, start_at(index), options);
        if (!fit) return std::nullopt;
        return Found{{}, fit->camera.camera_from_world, fit};
    }

    /// What the camera travels during the exposure against what it travels in a frame's time: the median over the
    /// frames in which both show clearly.
    std::optional<double> shutter() const {
        std::vector<double> shares;
        for (const auto& [index, fit] : joint_) {
            const MovingCamera by_frame{fit.camera.camera_from_world, velocity(index), 1};
            for (const FittedSheet& seen : fit.sheets) {
                const double travel_px = SheetImage(*seen.sheet, by_frame, geometry_.camera).streak_px();
                if (travel_px > 2 * smeared_px) shares.push_back(seen.streak_px / travel_px);
            }
        }
        if (shares.empty()) return std::nullopt;
        return std::min(1.0, upper_median_in_place(shares));
    }

    /// Moves the poses of joint fits to mid-exposure where the camera sped up or slowed down: its acceleration is known
    /// from the poses of three frames, those that it corrects among them, so it is done twice.
    void correct_for_acceleration() {
        constexpr int rounds = 2;
        for (int round = 0; round < rounds; ++round) {
            const std::optional<double> share = shutter();
            if (!share) return;
            std::map<std::size_t, RigidTransform> corrected;
            for (auto& [index, fit] : joint_) {
                if (index == 0 || index + 1 >= poses_.size() || !poses_[index - 1] || !poses_[index + 1]) continue;
                const PoseStep acceleration = perturbation_between(*poses_[index], *poses_[index - 1]) +
                                              perturbation_between(*poses_[index], *poses_[index + 1]);
                const PoseStep step = fit.pose_by_bend * (*share * *share * acceleration);
                corrected[index] = perturbed(fit.camera.camera_from_world, step);
            }
            for (const auto& [index, pose] : corrected) poses_[index] = pose;
        }
    }

    void take_joint_fits() {
        correct_for_acceleration();
        for (auto& [index, fit] : joint_) {
            fit.camera.camera_from_world = *poses_[index];
            std::vector<TagObservation> tags;
            for (const FittedSheet& sheet : fit.sheets) {
                if (sheet.correlation < least_sheet_correlation || !(sheet.contrast > 0)) continue;
                if (const auto tag = joint_observation(fit, sheet)) tags.push_back(*tag);
            }
            if (tags.empty()) continue;
            for (TagObservation& tag : tags) tag.covariance *= static_cast<double>(tags.size());
            added_ += static_cast<std::int64_t>(tags.size());
            // Single fits of smeared tags have nothing to add.
            clip_.frames[index].tags = std::move(tags);
            std::ranges::stable_sort(clip_.frames[index].tags, {}, &TagObservation::id);
        }
    }

    /// The corners of a sheet at mid-exposure by the pose of a joint fit, with the pose's covariance.
    std::optional<TagObservation> joint_observation(const RigImageFit& fit, const FittedSheet& fitted) const {
        const PlacedSheet& sheet = *fitted.sheet;
        const RigidTransform& pose = fit.camera.camera_from_world;
        const Camera& camera = geometry_.camera;
        const std::optional<ExpectedSheet> expected = expected_sheet(sheet, pose, camera);
        if (!expected) return std::nullopt;
        TagObservation tag;
        tag.id = sheet.id;
        tag.joint = tag.refined = true;
        tag.correlation = fitted.correlation;
        tag.contrast = fitted.contrast;
        tag.side_px = expected->side_px;
        tag.corners_px = expected->corners_px;
        Eigen::Matrix<double, 8, 6> jacobian;
        const Eigen::Matrix<double, 3, 4> world = sheet.world_from_tag * tag_corners_m(sheet.size_m);
        for (int i = 0; i < 4; ++i) {
            // Measured in the plate through the solve's lens; undone as every other tag's are.
            tag.corners_normalized.col(i) = context_.camera.normalized_from_pixel(tag.corners_px.col(i));
            const Eigen::Vector3d point = pose * world.col(i);
            Eigen::Matrix<double, 2, 3> by_point;
            by_point << 1, 0, -point.x() / point.z(), 0, 1, -point.y() / point.z();
            by_point /= point.z();
            Eigen::Matrix3d cross;
            cross << 0, -world(2, i), world(1, i), world(2, i), 0, -world(0, i), -world(1, i), world(0, i), 0;
            const Eigen::Matrix<double, 2, 3> by_world = by_point * pose.linear();
            jacobian.block<2, 6>(2 * i, 0) << -by_world * cross, by_world;
        }
        if (!tag.corners_normalized.allFinite()) return std::nullopt;
        tag.covariance = jacobian * fit.covariance * jacobian.transpose();
        // Six numbers cannot spread over eight: what two of them lack is a hundredth of a pixel.
        constexpr double floor_px = 0.01;
        tag.covariance.diagonal().array() += std::pow(floor_px / camera.fx, 2);
        const Eigen::Vector3d centre = sheet.world_from_tag.translation();
        tag.streak_px = camera.pixel_from_camera(fit.camera.at(0.5) * centre) -
                        camera.pixel_from_camera(fit.camera.at(-0.5) * centre);
        tag.blur_covariance_px2 = fit.camera.blur_px * fit.camera.blur_px * Eigen::Matrix2d::Identity() +
                                  *tag.streak_px * tag.streak_px->transpose() / 12;
        // Across the sheet's vertical edges, then its horizontal ones.
        const Eigen::Vector2d up = tag.corners_px.col(3) - tag.corners_px.col(0);
        const Eigen::Vector2d right = tag.corners_px.col(1) - tag.corners_px.col(0);
        const auto across = [&](const Eigen::Vector2d& edge) {
            const Eigen::Vector2d normal = Eigen::Vector2d(-edge.y(), edge.x()).normalized();
            return std::sqrt(normal.dot(tag.blur_covariance_px2 * normal));
        };
        tag.blur_px = {across(up), across(right)};
        return tag;
    }

    void take(std::size_t index, const Found& found) {
        poses_[index] = found.camera_from_world;
        if (found.joint) joint_[index] = *found.joint;
        auto& tags = clip_.frames[index].tags;
        for (const TagObservation& tag : found.tags) {
            std::erase_if(tags, [&](const TagObservation& old) { return old.id == tag.id; });
            tags.push_back(tag);
            ++added_;
        }
        std::ranges::stable_sort(tags, {}, &TagObservation::id);
    }

    const ClipContext& context_;
    const GeometrySolution& geometry_;
    ClipObservations& clip_;
    PlateLight plate_light_;
    LensGrid lens_, solved_lens_;
    std::vector<PlacedSheet> sheets_;
    std::vector<std::optional<RigidTransform>> poses_;  // parallel to the frames
    std::map<std::size_t, RigImageFit> joint_;          // by frame
    std::int64_t added_ = 0;
};

}  // namespace

std::int64_t recover_tags(const ClipContext& context, FrameSource& source, const GeometrySolution& geometry,
                          ClipObservations& clip) {
    return Recovery(context, geometry, clip).run(source);
}

}  // namespace matchlight
