// What the pointer does to the scene in its picture: it picks objects, drags their handles, and focuses.
#pragma once

#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "preview/canvas.h"
#include "preview/handles.h"
#include "preview/session.h"

namespace matchlight {

class Hand {
public:
    /// Behind the canvas' in every frame of ImGui's: does what the pointer does, draws the handles of what is chosen.
    void lay_out(const Region& area, float scale, const Canvas& canvas, Session& session);
    /// A file that was dropped at a place of the window; what stands on the surface stands where that shows it.
    void drop(const std::filesystem::path& file, const Eigen::Vector2d& window_px, const Region& area,
              const Canvas& canvas, Session& session) const;

    /// What is held, or would be; empty: nothing.
    const std::string& says() const { return says_; }
    bool holds() const { return held_.has_value() || focuses_; }
    /// Whether it knows all objects that could be picked.
    bool idle() const { return !loading_.valid(); }

private:
    /// Of a frame of the window.
    struct Sight;
    struct Held {
        std::size_t object = 0;
        HandleDrag drag;
    };
    struct Under {
        std::optional<std::size_t> object;
        Grab grab;
    };

    void keep_targets(const Scene& scene);
    std::optional<Handles> handles_of(const Sight& sight, std::size_t object) const;
    Under under(const Sight& sight) const;
    void grab(const Sight& sight, Session& session);
    void drag_on(const Sight& sight, Session& session);
    void focus(const Sight& sight, Session& session) const;
    void draw(const Sight& sight, const Under& under) const;
    std::string told(const Sight& sight, const Under& under) const;

    PickTargets targets_;
    std::vector<ObjectSettings> of_targets_;  // what of the scene's objects they depend on
    std::future<PickTargets> loading_;
    std::optional<Held> held_;
    bool down_ = false;
    bool focuses_ = false;
    Eigen::Vector2d last_px_ = Eigen::Vector2d::Zero();
    std::string says_;
};

}  // namespace matchlight
