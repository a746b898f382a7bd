// What one thread works on, seen from another: how far it is, and a way to have it given up.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

namespace matchlight {

struct WorkStage {
    std::string name;  // "shadow/contact"; empty: nothing was told
    std::int64_t done = 0;
    std::int64_t all = 0;  // 0: not known
};

class Work {
public:
    /// From the beginning, and not given up.
    void begin();
    void give_up() { given_up_ = true; }
    bool is_given_up() const { return given_up_; }
    void tell(std::string_view name, std::int64_t done, std::int64_t all);
    WorkStage stage() const;

private:
    std::atomic<bool> given_up_ = false;
    mutable std::mutex mutex_;
    WorkStage stage_;
};

/// As long as it lives, this thread works on `work`.
class WorkScope {
public:
    explicit WorkScope(Work& work);
    ~WorkScope();
    WorkScope(const WorkScope&) = delete;
    WorkScope& operator=(const WorkScope&) = delete;

private:
    Work* before_;
};

// Of what this thread works on; outside of every WorkScope nothing is told, and nothing given up.
void tell_work(std::string_view name, std::int64_t done = 0, std::int64_t all = 0);
bool work_is_given_up();
/// Throws InputError where it is given up.
void stop_if_given_up();

}  // namespace matchlight
