// A thread knows its work by itself, so that what is deep within need not be handed it.
#include "core/work.h"

#include <utility>

#include "core/error.h"

namespace matchlight {

namespace {

thread_local Work* work_of_thread = nullptr;

}  // namespace

void Work::begin() {
    const std::lock_guard lock(mutex_);
    given_up_ = false;
    stage_ = {};
}

void Work::tell(std::string_view name, std::int64_t done, std::int64_t all) {
    const std::lock_guard lock(mutex_);
    stage_ = {.name = std::string(name), .done = done, .all = all};
}

WorkStage Work::stage() const {
    const std::lock_guard lock(mutex_);
    return stage_;
}

WorkScope::WorkScope(Work& work) : before_(std::exchange(work_of_thread, &work)) {}

WorkScope::~WorkScope() {
    work_of_thread = before_;
}

void tell_work(std::string_view name, std::int64_t done, std::int64_t all) {
    if (work_of_thread != nullptr) work_of_thread->tell(name, done, all);
}

bool work_is_given_up() {
    return work_of_thread != nullptr && work_of_thread->is_given_up();
}

void stop_if_given_up() {
    if (work_is_given_up()) throw InputError({}, "what was being made was given up");
}

}  // namespace matchlight
