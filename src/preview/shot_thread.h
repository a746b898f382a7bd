// The shot at work on a thread of its own, with a context of its own, so that the window never waits for it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/work.h"
#include "preview/shot.h"
#include "preview/truth_picture.h"

namespace matchlight {

/// What is known of a shot once it is loaded.
struct ShotFacts {
    Scene scene;
    Solve solve;
    FootageInfo footage;
    ShotLevel level;  // as the scene has it
};

struct PictureRequest {
    std::int64_t frame = 0;       // or the next that can be decoded
    bool backwards = false;       // or the one before it, where there is one
    std::optional<double> due_s;  // while it plays: go on from there to the last frame whose time has come
    ShotLevel level;
    std::shared_ptr<const Scene> scene = {};   // as it was changed; null: as its file had it
    bool dragging = false;                     // it changes with every request: coarse will do
    std::optional<CameraView> free_view = {};  // the composite is what is seen from there, and no plate behind it
    std::string watched_pass = {};             // what it leaves is shown, too; "": of none
    std::optional<ProbeForm> probe = {};       // the probe is shown
    bool composite = true;
    bool plate = false;
    bool difference = false;  // FLIP of the composite against the truth, or where there is none against the plate
    bool passes = false;      // timed
    std::filesystem::path truth = {};  // as TruthPictures takes it; empty: not wanted
};

struct ShotPicture {
    std::int64_t serial = 0;  // of the request
    std::int64_t frame = 0;
    double time_s = 0;
    std::optional<double> next_time_s;  // while it plays: of the frame after it; absent at the end
    Image8 composite, plate;            // empty unless asked for
    Image8 truth, difference;           // and where there is none
    double mean_flip = 0;               // of the difference
    bool flip_of_plate = false;         // it is against the plate
    std::vector<PassReport> passes;
    Image8 watched_picture;     // the probe, or of the pass that is watched; empty where it left nothing
    std::string watched_words;  // about it
    // Where it was seen from; absent where that is not known.
    Camera camera;
    std::optional<RigidTransform> camera_from_world;
    double walk_s = 0;  // it took to decode
    double ms = 0;      // it took to composite
};

/// What came of what was asked for, since it was asked for last.
struct ShotNews {
    std::shared_ptr<const ShotFacts> facts;  // of a scene that was read
    std::optional<ShotPicture> picture;
    std::optional<ShaderReload> shaders;  // files changed: pictures are to be asked for anew
    std::exception_ptr failure;           // of the last request
};

class ShotThread {
public:
    /// Begins to read the scene. `wake` is called, on the thread, when there are news; `warnings` must outlive it.
    ShotThread(std::filesystem::path scene, bool quiet, Warnings& warnings, std::function<void()> wake);
    ~ShotThread();
    ShotThread(const ShotThread&) = delete;
    ShotThread& operator=(const ShotThread&) = delete;

    /// Reads the scene file again; what stands there cannot be shown: the old scene stays.
    void reload();
    /// Takes the place of what was asked for and not begun. Returns its serial number.
    std::int64_t ask(const PictureRequest& request);

    /// What it draws is given up; where that was what was asked for last, nothing comes of it. What it loads, it loads.
    void give_up();

    ShotNews take();
    /// Nothing to do, and no news.
    bool idle() const;
    /// For how long it has been at what it does; 0 where it does nothing, or nothing that is wanted still.
    double busy_s() const;
    /// Where it is in that.
    WorkStage stage() const { return work_.stage(); }

private:
    void work();
    void do_next(std::unique_lock<std::mutex>& lock);
    void load();
    void take_wishes(const PictureRequest& request);
    const TruthPictures& truth_of(const std::filesystem::path& path);
    ShotPicture picture_of(const PictureRequest& request);
    void look_at_shaders();

    const std::filesystem::path path_;
    const bool quiet_;
    Warnings& warnings_;
    const std::function<void()> wake_;

    // The thread's own.
    std::unique_ptr<GlContext> context_;
    std::unique_ptr<Shot> shot_;
    std::optional<TruthPictures> truth_;
    std::shared_ptr<const Scene> scene_;  // that the shot took last

    mutable std::mutex mutex_;
    std::condition_variable more_;
    bool stop_ = false;
    bool load_ = true;
    std::optional<PictureRequest> request_;
    std::int64_t serial_ = 0;
    bool at_work_ = false;
    bool is_loading_ = false;
    Work work_;
    std::chrono::steady_clock::time_point began_;
    ShotNews news_;
    bool has_news_ = false;
    std::thread thread_;
};

}  // namespace matchlight
