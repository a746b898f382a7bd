// The picture in the window: which one, how large, and what is under the pointer.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include <Eigen/Core>

#include "core/image.h"
#include "preview/picture_view.h"

namespace matchlight {

enum class ShownKind { composite, plate, truth, difference, texture };

/// What a hand does to the picture as a whole.
struct CanvasMotion {
    Eigen::Vector2d drag_px = Eigen::Vector2d::Zero();  // right or middle button, window pixels of this frame
    double wheel = 0;                                   // steps
};

class Canvas {
public:
    void set_picture(ShownKind kind, const Image8& picture, double pixel_aspect);
    /// Takes away what is of another frame.
    void remove_picture(ShownKind kind);

    // What is to be shown.
    ShownKind shown = ShownKind::composite;
    bool wipe = false;          // the composite on the left of a line
    bool leads_camera = false;  // drags and the wheel are a camera's, and do not zoom
    void fit() { zoom_.reset(); }
    /// Window pixels for one of the picture, about its middle.
    void set_zoom(double zoom);

    /// Takes part in ImGui's frame: wheel, drags and the wipe's handle.
    void lay_out(const Region& area, float scale);
    /// Whether it looks otherwise than at the last call.
    bool take_change(const Region& area);
    void draw(PictureView& view, const Region& area);

    /// Left, top, width, height of the picture in the window.
    Eigen::Vector4f place(const Region& area) const;
    /// The picture's pixel under a point of the window, whole numbers at pixel centres; where there is none, beyond it.
    Eigen::Vector2d pixel_at(const Eigen::Vector2d& window_px, const Region& area) const;
    Eigen::Vector2d window_at(const Eigen::Vector2d& pixel, const Region& area) const;
    /// Under the pointer.
    const std::optional<Eigen::Vector2i>& hovered() const { return hovered_; }
    /// Whether the pointer's left button went down on the picture, or is held since, and nothing else here takes it.
    bool hand_is_free() const { return hand_is_free_; }
    /// Of this frame, where it leads a camera.
    const CanvasMotion& motion() const { return motion_; }
    double zoom(const Region& area) const { return place(area)[3] / picture_px_.y(); }

private:
    ShownPicture& picture(ShownKind kind) { return pictures_[static_cast<std::size_t>(kind)]; }
    void zoom_about(const Eigen::Vector2d& window_px, double factor, const Region& area);
    double wipe_x(const Region& area) const;

    std::array<ShownPicture, 5> pictures_;
    std::array<bool, 5> has_{};
    PictureSize displayed_{1, 1};
    Eigen::Vector2i picture_px_ = Eigen::Vector2i::Ones();
    std::optional<double> zoom_;                        // absent: it fits
    Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();  // displayed pixels, in the middle of the window's area
    double wipe_share_ = 0.5;                           // of the area's width
    /// What draw() depends on.
    struct Look {
        std::int64_t pictures = 0;  // that were set or taken away
        ShownKind shown = ShownKind::composite;
        std::optional<double> wipe_x;
        bool leads_camera = false;
        Eigen::Vector4f place = Eigen::Vector4f::Zero();
        bool operator==(const Look&) const = default;
    };
    Look look_;
    std::int64_t pictures_set_ = 0;
    bool moves_wipe_ = false;
    bool hand_is_free_ = false;
    CanvasMotion motion_;
    std::optional<Eigen::Vector2i> hovered_;
};

}  // namespace matchlight
