// A scene being looked at: which frame, how it is drawn, whether it plays, and the last picture that came of it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "preview/keys.h"
#include "preview/playback_clock.h"
#include "preview/shot_thread.h"

namespace matchlight {

struct SessionOptions {
    std::filesystem::path scene;
    std::int64_t frame = 0;
    std::optional<QualityLevel> level;  // instead of the scene's
    std::filesystem::path truth = {};   // as truth_picture() takes it
    bool quiet = false;
    bool strict = false;  // what fails is thrown, not only told
    std::function<void(const std::string&)> print;
    std::function<void()> wake;  // when something came of what the shot's thread does
};

/// Which pictures of a frame.
struct WantedPictures {
    bool composite = true, plate = false, truth = false, difference = false;
    bool operator==(const WantedPictures&) const = default;
};

class Session {
public:
    Session(SessionOptions options, Warnings& warnings);

    /// Takes what the thread has done and asks for what is wanting. Throws what it threw, as long as nothing could be
    /// shown yet.
    void update();
    /// Until nothing is left to do but play.
    void settle();

    /// Null until the scene is read.
    const ShotFacts* facts() const { return facts_.get(); }
    const std::optional<ShotPicture>& picture() const { return picture_; }
    /// Whether the picture is another one than at the last call.
    bool take_change() { return std::exchange(changed_, false); }

    void go_to(std::int64_t frame, bool backwards = false);
    void step(std::int64_t frames);
    void play(bool on);
    bool playing() const { return playing_; }
    std::int64_t frame() const { return frame_; }
    std::int64_t frame_count() const { return facts_ ? facts_->footage.frame_count : 0; }

    const ShotSwitches& switches() const { return switches_; }
    void set_switches(const ShotSwitches& switches);
    void want(const WantedPictures& wanted);
    void ask_for_passes();
    void reload();

    /// What is wrong, in a line; empty: nothing.
    const std::string& trouble() const { return shader_trouble_.empty() ? trouble_ : shader_trouble_; }
    void set_trouble(const std::string& trouble);
    bool idle() const;
    double busy_s() const { return thread_.busy_s(); }
    /// Seconds until the next frame is due; nothing while it does not play.
    std::optional<double> next_due_s() const;
    void print(const std::string& text) const { options_.print(text); }

private:
    void take(ShotNews news);
    void take_facts(std::shared_ptr<const ShotFacts> facts);
    void take_picture(ShotPicture picture);
    void take_shaders(const ShaderReload& shaders);
    void ask();

    SessionOptions options_;
    std::shared_ptr<const ShotFacts> facts_;
    std::optional<ShotPicture> picture_;
    ShotSwitches switches_;
    PlaybackClock clock_;
    std::int64_t frame_ = 0;  // wanted
    bool backwards_ = false;
    WantedPictures wanted_;
    bool passes_ = false;
    bool stale_ = true;   // the picture is not what is wanted, and not asked for
    bool asked_ = false;  // and has not come
    bool playing_ = false;
    bool changed_ = false;
    std::string trouble_;         // of the last attempt
    std::string shader_trouble_;  // until it is mended
    ShotThread thread_;
};

}  // namespace matchlight
