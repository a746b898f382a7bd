// The libraries log from any of their threads.
#include "media/av_log.h"

#include <array>
#include <cstdarg>
#include <cstdio>
#include <utility>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/error.h>
#include <libavutil/log.h>
}

namespace matchlight {

namespace {

void on_log(void* context, int level, const char* format, va_list arguments) {
    if (level > AV_LOG_ERROR || context == nullptr) return;
    const AVClass* type = *static_cast<AVClass**>(context);
    void* log = nullptr;
    if (type == avcodec_get_class()) {
        log = static_cast<AVCodecContext*>(context)->opaque;
    } else if (type == avformat_get_class()) {
        log = static_cast<AVFormatContext*>(context)->opaque;
    }
    if (log == nullptr) return;
    std::array<char, 512> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    static_cast<AvLog*>(log)->add(text.data());
}

}  // namespace

void AvLog::install() {
    static const bool installed = [] {
        av_log_set_callback(on_log);
        return true;
    }();
    static_cast<void>(installed);
}

void AvLog::add(const std::string& message) {
    const std::lock_guard lock(mutex_);
    if (!first_error_.empty()) return;
    first_error_ = message.substr(0, message.find('\n'));
}

bool AvLog::has_errors() {
    const std::lock_guard lock(mutex_);
    return !first_error_.empty();
}

std::string AvLog::take_cause() {
    const std::lock_guard lock(mutex_);
    std::string cause = std::exchange(first_error_, {});
    return cause.empty() ? cause : " (" + cause + ")";
}

std::string av_error_text(int code) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(code, text.data(), text.size());
    return text.data();
}

}  // namespace matchlight
