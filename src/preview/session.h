// A scene being looked at and changed: which frame, how exactly, whether it plays, and the last picture of it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "preview/playback_clock.h"
#include "preview/scene_history.h"
#include "preview/scene_values.h"
#include "preview/shot_thread.h"

namespace matchlight {

struct SessionOptions {
    std::filesystem::path scene;
    std::int64_t frame = 0;
    std::optional<QualityLevel> level;  // instead of the scene's
    std::filesystem::path truth = {};   // as TruthPictures takes it
    bool quiet = false;
    bool strict = false;  // what fails is thrown, not only told; and no picture is drawn coarsely first
    std::function<void(const std::string&)> print;
    std::function<void()> wake;  // when something came of what the shot's thread does
};

/// Which pictures of a frame.
struct WantedPictures {
    bool composite = true, plate = false, truth = false, difference = false;
    bool operator==(const WantedPictures&) const = default;
};

/// While things change pictures are drawn at the level `preview`; where they rest, at the level that is asked for, by
/// a second shot, so that the next change need not wait for it.
class Session {
public:
    Session(SessionOptions options, Warnings& warnings);

    /// Takes what the threads have done and asks for what is wanting. Throws what they threw, as long as nothing could
    /// be shown yet.
    void update();
    /// Until nothing is left to do but play.
    void settle();

    /// Null until the scene is read.
    const ShotFacts* facts() const { return facts_.get(); }
    const std::optional<ShotPicture>& picture() const { return picture_; }
    /// How many there were.
    std::int64_t picture_count() const { return pictures_; }
    /// Whether the picture, or what is told about it, is another one than at the last call of take_change().
    bool has_change() const { return changed_; }
    bool take_change() { return std::exchange(changed_, false); }

    void go_to(std::int64_t frame, bool backwards = false);
    void step(std::int64_t frames);
    void play(bool on);
    bool playing() const { return playing_; }
    std::int64_t frame() const { return frame_; }
    std::int64_t frame_count() const { return facts_ ? facts_->footage.frame_count : 0; }

    const ShotLevel& level() const { return level_; }
    /// How sets of spheres are drawn that take too long to be followed by a hand: opaque while the view or anything
    /// else moves; seen through, layer by layer, as it rests, where any lets light through; then as the level has them,
    /// shading each other. Empty: as the level has them, always.
    std::string sphere_mode() const;
    void set_level(const ShotLevel& level);
    void want(const WantedPictures& wanted);
    void ask_for_passes();
    /// The camera that a hand leads; nullopt: the footage's own.
    const std::optional<CameraView>& free_view() const { return free_view_; }
    void set_free_view(const std::optional<CameraView>& view);
    /// Milliseconds of the last pictures, the latest at the end.
    const std::vector<float>& picture_times_ms() const { return picture_times_ms_; }
    /// The passes of the last frame that was measured, to a text file beside the scene.
    void write_passes();
    /// The pass whose texture is shown; "": none.
    const std::string& watched_pass() const { return watched_pass_; }
    void watch(const std::string& pass);
    /// The probe is shown instead; nullopt: it is not.
    const std::optional<ProbeForm>& shown_probe() const { return shown_probe_; }
    void show_probe(const std::optional<ProbeForm>& form);
    /// Reads the scene file again, and all that belongs to it.
    void reload();

    // The scene as it was changed. Every change is one of its text; what cannot be read is told, and changes nothing.
    const Scene& scene() const { return *scene_; }
    const SceneValues& values() const { return values_; }
    const SceneHistory& history() const { return *history_; }
    /// Those of one `drag` are one step to be undone.
    void set(const std::string& key, const SceneValue& value, const std::string& drag = {});
    void remove(const std::string& key);
    void change(const std::function<void(SceneText&)>& edit, const std::string& what, const std::string& drag = {});
    /// What is held is let go of.
    void end_drag();
    void undo();
    void redo();
    void save();
    /// The object that panel and handles are of.
    std::optional<std::size_t> chosen() const;
    void choose(std::optional<std::size_t> object) { chosen_ = object; }
    void add_object(const SceneEntries& entries);
    void remove_chosen();
    /// A model or a set of spheres stands there; a picture of light becomes the probe.
    void take_file(const std::filesystem::path& file, const Eigen::Vector3d& translate_m);
    /// What is being drawn of an aperture (aperture_sketch.h), and no part of the scene before it is taken.
    std::vector<Eigen::Vector2d>& aperture_corners() { return aperture_corners_; }
    /// A key whose value is "off" or 0 becomes what it was when it was switched off, or `on`; any other, `off`.
    void toggle(const std::string& key, const SceneValue& off, const SceneValue& on);

    /// What is wrong, in a line; empty: nothing.
    const std::string& trouble() const { return shader_trouble_.empty() ? trouble_ : shader_trouble_; }
    /// Does it; where it cannot be done, that is told.
    void attempt(const std::function<void()>& action);
    bool idle() const;
    double busy_s() const;
    /// Whether that is long enough to be told.
    bool is_told() const;
    /// Where it is in that, in words and, where that is known, as a share.
    WorkStage stage() const;
    /// What is being drawn is given up: the picture that there is stays until something is changed.
    void give_up();
    /// Seconds until the next frame is due, or a picture is to be made exact; nothing where neither is.
    std::optional<double> next_due_s() const;
    void print(const std::string& text) const { options_.print(text); }

private:
    using Clock = PlaybackClock::Clock;

    /// A thread, and for which wishes it was asked last.
    struct Drawer {
        std::unique_ptr<ShotThread> thread;
        std::int64_t wish = 0;
        bool asked = false;
        std::int64_t serial = 0;  // what the thread calls that
        bool passes = false;      // they are to be timed
    };

    void touch();
    void give_up(Drawer& drawer);
    /// As it is written by hand: relative to the scene where it lies beside or below it.
    std::string written(const std::filesystem::path& file) const;
    /// What a picture is drawn for.
    enum class Stage { quick, peeled, exact };

    bool wants_exact() const;
    bool simplifies_spheres() const;
    /// Whether spheres that let light through are drawn so before they shade each other, too.
    bool peels_first() const;
    ShotLevel quick_level() const;
    void take(Drawer& drawer, Stage stage);
    void take_facts(std::shared_ptr<const ShotFacts> facts);
    void take_picture(ShotPicture picture, Stage stage);
    void take_shaders(const ShaderReload& shaders);
    void take_text(const SceneText& text);
    void set_trouble(const std::string& trouble);
    void ask(Drawer& drawer, const ShotLevel& level);
    /// What is asked for once a hand rests: one stage after the other.
    void ask_at_rest();
    void ask_own_thread(Drawer& drawer, const ShotLevel& level);

    SessionOptions options_;
    Warnings& warnings_;
    std::shared_ptr<const ShotFacts> facts_;
    std::optional<ShotPicture> picture_;
    std::int64_t pictures_ = 0;
    std::unique_ptr<SceneHistory> history_;
    std::shared_ptr<const Scene> scene_;
    SceneValues values_;
    std::map<std::string, std::string> switched_off_;  // keys, as they were written; empty: they were not
    std::optional<std::size_t> chosen_;
    std::vector<Eigen::Vector2d> aperture_corners_;
    ShotLevel level_;
    PlaybackClock clock_;
    std::int64_t frame_ = 0;  // wanted
    bool backwards_ = false;
    WantedPictures wanted_;
    std::optional<CameraView> free_view_;
    std::string watched_pass_;
    std::optional<ProbeForm> shown_probe_;
    std::vector<float> picture_times_ms_;
    bool has_quick_spheres_ = false;    // even as the level has them
    Stage shown_stage_ = Stage::quick;  // of the picture
    bool awaits_first_exact_ = true;    // the next one will be the first
    bool passes_ = false;
    bool playing_ = false;
    bool dragging_ = false;
    bool changed_ = false;
    std::string trouble_;         // of the last attempt
    std::string shader_trouble_;  // until it is mended
    std::int64_t wish_ = 1;       // counts changes of what is wanted
    Clock::time_point touched_ = Clock::now();
    Drawer quick_, peeled_, exact_;
};

}  // namespace matchlight
