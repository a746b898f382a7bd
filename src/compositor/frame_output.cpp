// Video keeps the plate's own samples; PNG shows the decoded plate; EXR holds linear light and every layer.
#include "compositor/frame_output.h"

#include <algorithm>

#include <fmt/format.h>

#include "compositor/exr_layers.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/lowercase.h"
#include "media/frame_sink.h"
#include "media/image_io.h"

namespace matchlight {

namespace fs = std::filesystem;

OutputKind output_kind(const fs::path& output) {
    const std::string ending = lowercase_extension(output);
    if (ending == ".mp4" || ending == ".mov" || ending == ".mkv") return OutputKind::video;
    if (ending == ".png") return OutputKind::png;
    if (ending == ".exr") return OutputKind::exr;
    throw InputError(output, "is no kind of output that is known", "name it .mp4, .mov, .mkv, _%04d.png or _%04d.exr");
}

namespace {

class VideoOutput : public FrameOutput {
public:
    VideoOutput(const OutputRequest& request, const FootageInfo& footage, const VideoOptions& options,
                Warnings& warnings)
        : options_(options), sink_(request.path, footage, options, warnings) {}

    bool needs_layers() const override { return options_.codec == VideoCodec::prores4444; }

    void write(const CompositedFrame& frame, const Compositor& compositor) override {
        if (needs_layers()) {
            sink_.write_rgba(compositor.virtual_layer_code(frame), frame.plate.index(), frame.plate.time_s());
        } else {
            sink_.write(frame.composited_plate());
        }
    }

    void finish() override { sink_.finish(); }

private:
    VideoOptions options_;
    VideoSink sink_;
};

/// Pictures are numbered by the footage's frames.
class PictureOutput : public FrameOutput {
public:
    explicit PictureOutput(const OutputRequest& request) : request_(request) {}

    void finish() override {}

protected:
    std::int64_t number_of(const CompositedFrame& frame) const { return frame.plate.index() + request_.first_number; }
    /// The frame's own name, checked against what is there.
    fs::path path_of(const CompositedFrame& frame) const {
        fs::path path = numbered(request_.path, number_of(frame));
        check_output(path, request_.overwrite);
        return path;
    }

    OutputRequest request_;
};

class PngOutput : public PictureOutput {
public:
    using PictureOutput::PictureOutput;

    bool needs_layers() const override { return false; }

    void write(const CompositedFrame& frame, const Compositor&) override {
        const ImageMetadata metadata{{"Software", request_.provenance}};
        if (frame.plate.format().bit_depth > 8) {
            write_png16(path_of(frame), frame.rgb16(), metadata);
        } else {
            write_png8(path_of(frame), frame.rgb8(), metadata);
        }
    }
};

class ExrOutput : public PictureOutput {
public:
    using PictureOutput::PictureOutput;

    bool needs_layers() const override { return true; }
    bool needs_exchange() const override { return true; }

    void write(const CompositedFrame& frame, const Compositor& compositor) override {
        write_exr_layers(path_of(frame), frame, compositor,
                         {.number = number_of(frame), .scene = request_.scene, .provenance = request_.provenance});
    }
};

VideoOptions video_options(const OutputRequest& request) {
    const std::optional<VideoCodec> codec = video_codec_from_name(request.settings.codec);
    if (!codec) {
        throw InputError(request.path, fmt::format("codec '{}' is not known", request.settings.codec),
                         "use h264, h265, ffv1 or prores4444");
    }
    VideoOptions options;
    options.codec = *codec;
    options.crf = request.settings.crf;
    options.pixel_format = request.settings.pixel_format;
    options.preset = request.settings.preset;
    options.copy_audio = request.settings.audio;
    options.comment = request.provenance;
    return options;
}

}  // namespace

std::unique_ptr<FrameOutput> open_frame_output(const OutputRequest& request, const FootageInfo& footage,
                                               Warnings& warnings) {
    const OutputKind kind = output_kind(request.path);
    if (kind == OutputKind::video) {
        check_output(request.path, request.overwrite);
        return std::make_unique<VideoOutput>(request, footage, video_options(request), warnings);
    }
    const fs::path first = numbered(request.path, request.first_number);
    check_output(first, true);  // the folder; each picture is checked when its turn comes
    if (kind == OutputKind::png) return std::make_unique<PngOutput>(request);
    return std::make_unique<ExrOutput>(request);
}

}  // namespace matchlight
