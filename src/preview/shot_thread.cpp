// The newest request wins; shader files are looked at while there is none.
#include "preview/shot_thread.h"

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "core/elapsed.h"
#include "core/error.h"
#include "preview/free_view.h"
#include "preview/texture_picture.h"
#include "report/flip.h"
#include "report/flip_colors.h"

namespace matchlight {

namespace {

using Clock = std::chrono::steady_clock;

/// Throws InputError where the truth has another size.
void add_difference(ShotPicture& picture) {
    const Image8& reference = picture.flip_of_plate ? picture.plate : picture.truth;
    const Image8& composite = picture.composite;
    if (reference.width() != composite.width() || reference.height() != composite.height()) {
        throw InputError({}, fmt::format("the truth has {}×{} pixels, the picture {}×{}", reference.width(),
                                         reference.height(), composite.width(), composite.height()));
    }
    const ImageF error = flip_error_map(reference, composite);
    double sum = 0;
    for (const float sample : error.samples()) sum += sample;
    picture.mean_flip = sum / static_cast<double>(error.samples().size());
    picture.difference = flip_colors(error);
}

}  // namespace

ShotThread::ShotThread(std::filesystem::path scene, bool quiet, Warnings& warnings, std::function<void()> wake)
    : path_(std::move(scene)), quiet_(quiet), warnings_(warnings), wake_(std::move(wake)), thread_([this] {
          work();
      }) {}

ShotThread::~ShotThread() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    more_.notify_all();
    thread_.join();
}

void ShotThread::reload() {
    const std::lock_guard lock(mutex_);
    load_ = true;
    more_.notify_all();
}

std::int64_t ShotThread::ask(const PictureRequest& request) {
    const std::lock_guard lock(mutex_);
    request_ = request;
    more_.notify_all();
    return ++serial_;
}

void ShotThread::give_up() {
    const std::lock_guard lock(mutex_);
    request_.reset();
    if (at_work_ && !is_loading_) work_.give_up();
}

ShotNews ShotThread::take() {
    const std::lock_guard lock(mutex_);
    has_news_ = false;
    return std::exchange(news_, {});
}

bool ShotThread::idle() const {
    const std::lock_guard lock(mutex_);
    return !load_ && !request_ && !at_work_ && !has_news_;
}

double ShotThread::busy_s() const {
    const std::lock_guard lock(mutex_);
    return at_work_ && !work_.is_given_up() ? seconds_since(began_) : 0;
}

void ShotThread::work() {
    constexpr auto look_every = std::chrono::milliseconds(300);
    std::unique_lock lock(mutex_);
    while (!stop_) {
        if (load_ || (request_ && shot_)) {
            do_next(lock);
        } else if (!more_.wait_for(lock, look_every, [&] { return stop_ || load_ || (request_ && shot_); })) {
            lock.unlock();
            look_at_shaders();
            lock.lock();
        }
    }
    lock.unlock();
    shot_.reset();  // where its context is current
    context_.reset();
}

void ShotThread::do_next(std::unique_lock<std::mutex>& lock) {
    const bool load_first = std::exchange(load_, false);
    const std::optional<PictureRequest> request = load_first ? std::nullopt : std::exchange(request_, std::nullopt);
    const std::int64_t serial = serial_;
    at_work_ = true;
    is_loading_ = load_first;
    work_.begin();
    began_ = Clock::now();
    lock.unlock();
    std::exception_ptr failure;
    std::optional<ShotPicture> picture;
    try {
        const WorkScope scope(work_);
        if (load_first) load();
        if (request) picture = picture_of(*request);
    } catch (...) {
        failure = std::current_exception();
    }
    lock.lock();
    at_work_ = false;
    has_news_ = true;
    if (picture) {
        picture->serial = serial;
        news_.picture = std::move(picture);
    }
    if (load_first && !failure) {
        news_.facts = std::make_shared<const ShotFacts>(
            ShotFacts{shot_->scene(), shot_->solve(), shot_->frames().info(), shot_->scene_level()});
    }
    if (failure && !work_.is_given_up()) news_.failure = failure;
    wake_();
}

void ShotThread::load() {
    if (!context_) context_ = create_offscreen_context();
    shot_ = std::make_unique<Shot>(*context_, path_, quiet_, warnings_);
    scene_.reset();
}

void ShotThread::take_wishes(const PictureRequest& request) {
    shot_->set_level(request.level);
    shot_->set_dragging(request.dragging);
    shot_->watch(request.watched_pass);
    if (!request.scene || request.scene == scene_) return;
    scene_ = request.scene;
    shot_->set_scene(*scene_);
}

const TruthPictures& ShotThread::truth_of(const std::filesystem::path& path) {
    if (!truth_ || truth_->path() != path) truth_.emplace(path);
    return *truth_;
}

ShotPicture ShotThread::picture_of(const PictureRequest& request) {
    const Clock::time_point start = Clock::now();
    take_wishes(request);
    FrameCache& frames = shot_->frames();
    const std::int64_t last = std::max<std::int64_t>(0, frames.info().frame_count - 1);
    const std::int64_t wanted = std::min(request.frame, last);
    std::optional<PlateFrame> plate = frames.at_or_after(wanted);
    if (!plate || (request.backwards && plate->index() > wanted)) {
        if (std::optional<PlateFrame> earlier = frames.before(plate ? wanted : last + 1)) plate = std::move(earlier);
    }
    if (!plate) throw InputError(frames.info().path, "no frame of it can be decoded");
    ShotPicture picture;
    if (request.due_s) {
        std::optional<PlateFrame> next = frames.at_or_after(plate->index() + 1);
        for (; next && next->time_s() <= *request.due_s; next = frames.at_or_after(plate->index() + 1)) {
            plate = std::move(next);
        }
        if (next) picture.next_time_s = next->time_s();
    }
    picture.frame = plate->index();
    picture.time_s = plate->time_s();
    picture.walk_s = seconds_since(start);
    const Clock::time_point decoded = Clock::now();
    if (request.free_view) {
        picture.composite = shot_->seen_from(*request.free_view, picture.frame);
    } else if (request.composite || request.passes || request.difference) {
        picture.composite = shot_->composited(*plate);
        if (const std::optional<WatchedTexture> watched = shot_->watched()) {
            picture.watched_picture =
                picture_of_texture(*watched, picture.composite.width(), picture.composite.height());
            picture.watched_words = words_of_texture(*watched);
        }
    }
    // After a picture, so that what is made once is not part of it.
    if (request.passes) picture.passes = shot_->passes(*plate);
    if (request.probe) {
        picture.watched_picture = shot_->probe_seen(*request.probe, *plate);
        picture.watched_words = *request.probe == ProbeForm::latlong
                                    ? "probe, as bright as in this frame: straight up is the first row"
                                    : "probe, as bright as in this frame: in a mirror, a rough one, and on paper";
    }
    picture.ms = 1000 * seconds_since(decoded);
    picture.camera = request.free_view ? shot_->free_camera() : shot_->solve().camera;
    if (request.free_view) {
        picture.camera_from_world = pose_of_view(*request.free_view);
    } else if (const SolvedFrame* solved = shot_->solve().find(plate->index())) {
        picture.camera_from_world = solved->camera_from_world;
    }
    const bool wants_truth = !request.truth.empty();
    if (wants_truth) picture.truth = truth_of(request.truth).of_frame(picture.frame).value_or(Image8());
    picture.flip_of_plate = picture.truth.width() == 0;
    if (request.plate || (request.difference && picture.flip_of_plate)) {
        picture.plate = plate->rgb8({0, 0, plate->format().width, plate->format().height});
    }
    if (request.difference) add_difference(picture);
    return picture;
}

void ShotThread::look_at_shaders() {
    if (!shot_) return;
    ShaderReload reload = shot_->reload_shaders();
    if (!reload.files_changed) return;
    const std::lock_guard lock(mutex_);
    news_.shaders = std::move(reload);
    has_news_ = true;
    wake_();
}

}  // namespace matchlight
