// Signal handlers do nothing but set a flag.
#include "core/stop.h"

#include <csignal>

#include "core/work.h"

namespace matchlight {

namespace {

volatile std::sig_atomic_t stop_flag = 0;

void on_signal(int number) {
    if (stop_flag != 0) {
        std::signal(number, SIG_DFL);
        std::raise(number);
    }
    stop_flag = 1;
}

}  // namespace

void install_stop_handlers() {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
}

bool stop_requested() {
    return stop_flag != 0 || work_is_given_up();
}

}  // namespace matchlight
