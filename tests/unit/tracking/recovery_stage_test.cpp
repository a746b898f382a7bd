// Tags behind a hand and in streaks, found again in a drawn clip whose poses are known.
#include "tracking/recovery_stage.h"

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixfmt.h>
}

#include "core/transfer.h"
#include "media/av_pointers.h"
#include "media/plate_format.h"
#include "moving_rig.h"

namespace matchlight {
namespace {

using test::corner_distance_px;
using test::ordinary_camera;

/// Grey pictures as footage, 24 a second.
class DrawnFootage : public FrameSource {
public:
    explicit DrawnFootage(std::vector<ImageF> pictures) : pictures_(std::move(pictures)) {
        info_.path = "drawn.mp4";
        info_.frame_count = static_cast<std::int64_t>(pictures_.size());
        info_.fps = 24;
        info_.format.width = pictures_.front().width();
        info_.format.height = pictures_.front().height();
    }

    const FootageInfo& info() const override { return info_; }
    void seek(std::int64_t frame) override { next_ = frame; }
    std::optional<PlateFrame> next() override {
        if (next_ >= info_.frame_count) return std::nullopt;
        const ImageF& picture = pictures_[static_cast<std::size_t>(next_)];
        std::shared_ptr<AVFrame> samples = allocated_frame(picture.width(), picture.height(), AV_PIX_FMT_RGB24);
        for (int y = 0; y < picture.height(); ++y) {
            for (int x = 0; x < picture.width(); ++x) {
                const double code = srgb_code_from_linear(std::min(picture.at(x, y), 1.0f));
                for (int c = 0; c < 3; ++c) {
                    samples->data[0][y * samples->linesize[0] + 3 * x + c] =
                        static_cast<std::uint8_t>(std::lround(255 * code));
                }
            }
        }
        const PlateFormat format = plate_format_of(*samples, 0, {}, "drawn.mp4");
        const std::int64_t index = next_++;
        return PlateFrame(std::move(samples), format, index, static_cast<double>(index) / info_.fps);
    }

private:
    std::vector<ImageF> pictures_;
    FootageInfo info_;
    std::int64_t next_ = 0;
};

/// A clip, its scene, and what a first look and a first path make of it.
class RecoveryTest : public testing::Test {
protected:
    /// Draws `count` frames; `view_of` gives each. Then looks for the `tag_count` first tags of the rig.
    void track(int count, const std::function<TagView(int)>& view_of, std::size_t tag_count) {
        std::vector<ImageF> pictures;
        for (int f = 0; f < count; ++f) {
            TagView view = view_of(f);
            view.tags.resize(tag_count);
            true_poses_.push_back(view.camera_from_world(0));
            pictures.push_back(reference_light(view));
            test::add_noise(pictures.back(), 1, static_cast<unsigned>(f + 1));
        }
        footage_ = std::make_unique<DrawnFootage>(std::move(pictures));
        for (std::size_t i = 0; i < tag_count; ++i) {
            const TagSheet sheet = test::three_sheets()[i];
            scene_.tags.rig.push_back({sheet.id, sheet.size_m, sheet.world_from_tag});
        }
        scene_.footage.video = "drawn.mp4";
        scene_.footage.camera = "drawn.yaml";  // the lens is known
        options_.quiet = true;
        ObserveOptions observing;
        observing.quiet = true;
        clip_ = observe_clip(*footage_, scene_.tags, camera_, response_, observing);
        const GeometrySolution first = solve_geometry(context(), clip_);
        for (const PathFrame& frame : first.path.frames) seen_at_first_.push_back(!frame.tags.empty());
        added_ = recover_tags(context(), *footage_, first, clip_);
        path_ = solve_geometry(context(), clip_).path;
    }

    ClipContext context() { return {scene_, options_, footage_->info(), camera_, response_, probe_, warnings_}; }

    double error_px(int frame) const {
        const auto index = static_cast<std::size_t>(frame);
        const auto& pose = path_.frames[index].pose;
        return pose ? corner_distance_px(pose->camera_from_world, true_poses_[index], camera_) : 1e9;
    }
    bool is_seen(int frame) const { return !clip_.frames[static_cast<std::size_t>(frame)].tags.empty(); }

    Camera camera_ = ordinary_camera();
    Response response_;
    Scene scene_;
    TrackOptions options_;
    std::optional<Probe> probe_;
    Warnings warnings_;
    std::unique_ptr<DrawnFootage> footage_;
    std::vector<RigidTransform> true_poses_;
    ClipObservations clip_;
    std::vector<bool> seen_at_first_;
    std::int64_t added_ = 0;
    CameraPath path_;
};

/// A slow walk past the tags: 2 px a frame.
TagView walking_view(int frame) {
    const RigidTransform pose = test::orbit_pose(0.45, 30 + 0.2 * frame, 20, 8);
    TagView view = test::moving_view(pose, PoseStep::Zero(), PoseStep::Zero());
    view.exposure_s = 0;
    return view;
}

/// A card that hides the left `share` of tag 0.
HidingCard card_over(double share) {
    HidingCard card;
    card.width_m = 0.2, card.height_m = 0.2;
    card.world_from_card.translation() = Eigen::Vector3d(-0.1 - 0.04 + 0.08 * share, 0, 0.002);
    return card;
}

TEST_F(RecoveryTest, ATagThatAHandHalfHidesIsNotLost) {
    // From frame 5 on its only tag is hidden to two fifths, border and all, for longer than a gap is bridged.
    track(
        18,
        [](int f) {
            TagView view = walking_view(f);
            if (f >= 5) view.cards.push_back(card_over(0.4));
            return view;
        },
        1);
    EXPECT_FALSE(seen_at_first_[9]);
    EXPECT_GT(added_, 6);
    for (int f = 0; f < 18; ++f) EXPECT_LT(error_px(f), f < 5 ? 0.15 : 0.6) << f;
}

TEST_F(RecoveryTest, AHiddenTagIsNotFound) {
    track(
        12,
        [](int f) {
            TagView view = walking_view(f);
            if (f >= 5) view.cards.push_back(card_over(1.1));
            return view;
        },
        1);
    EXPECT_EQ(added_, 0);
    for (int f = 5; f < 12; ++f) EXPECT_FALSE(is_seen(f)) << f;
}

TEST_F(RecoveryTest, APanThatSmearsEveryTagHasItsPoses) {
    // The picture runs up to 48 px a frame, its shutter open half of the time, speeding up and slowing down by 16 px a
    // frame: frames 4 to 6 show no tag to the detector.
    const auto position_px = [](double f) {
        const double t = std::clamp(f - 2, 0.0, 6.0);
        return t < 3 ? 8 * t * t : 144 - 8 * (6 - t) * (6 - t);
    };
    track(
        11,
        [&](int f) {
            TagView view = walking_view(0);
            const RigidTransform still = view.camera_from_world(0);
            view.exposure_s = 0.5;
            view.camera_from_world = [=](double time) {
                const double m = (position_px(f + time) - 72) * 0.45 / ordinary_camera().fx;
                PoseStep way = PoseStep::Zero();
                way[3] = m, way[4] = 0.3 * m;
                return perturbed(still, way);
            };
            return view;
        },
        3);
    EXPECT_FALSE(seen_at_first_[5]);
    for (int f = 0; f < 11; ++f) {
        EXPECT_TRUE(is_seen(f)) << f;
        EXPECT_LT(error_px(f), 0.3) << f;
    }
}

}  // namespace
}  // namespace matchlight
