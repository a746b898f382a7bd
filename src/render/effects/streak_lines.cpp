// Plans the taps, and draws along rows that the line shifts by fractions of a texel.
#include "render/effects/streak_lines.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

namespace matchlight {
namespace {

float share_of(double weight, double all) {
    return static_cast<float>(weight / all);
}

/// A pass of `count` taps, the last of them weighted by `last_share` too; multiplies `gain` by what they sum to.
StreakTaps::Pass pass_of(int stride, int count, double last_share, double attenuation, double& gain) {
    std::vector<double> weights;
    double sum = 0;
    for (int s = 0; s < count; ++s) {
        weights.push_back(std::pow(attenuation, static_cast<double>(stride) * s) * (s + 1 == count ? last_share : 1));
        sum += weights.back();
    }
    StreakTaps::Pass pass{.stride = stride, .weights = {}};
    for (const double weight : weights) pass.weights.push_back(share_of(weight, sum));
    gain *= sum;
    return pass;
}

/// `region` as light spreads along the line by up to `texels` of the major axis.
Region spread(const Region& region, const StreakLine& line, int texels) {
    const int aside = static_cast<int>(std::ceil(std::abs(line.slope) * texels)) + 1;
    const int right = line.is_steep ? aside : texels, down = line.is_steep ? texels : aside;
    return {region.x - right, region.y - down, region.width + 2 * right, region.height + 2 * down};
}

class LinePasses {
public:
    LinePasses(RenderGraph& graph, ShaderLibrary& shaders, const StreakLine& line, const StreakPasses& passes)
        : graph_(graph), shaders_(shaders), line_(line), passes_(passes) {}

    /// The light on the line's rows.
    GraphTexture add_shifted(GraphTexture light) {
        if (line_.is_whole()) return light;
        const GraphShape shape = graph_.shape(light);
        GraphPass pass = new_pass("shift", shape.scale, spread(shape.region, line_, 0));
        pass.reads = {{light, 1}};
        Program& program = shaders_.full_screen("effects/streaks/shift.frag", line_defines());
        pass.draw = [&program, light, slope = line_.slope](PassRun& run) {
            program.use();
            run.bind(program, "source", 0, light);
            program.set("slope", slope);
            run.draw(program);
        };
        return graph_.add_pass(std::move(pass)).front();
    }

    struct Streaks {
        GraphTexture forward, backward;
    };

    Streaks add_pass(const Streaks& from, std::size_t index, GraphTexture source) {
        const StreakTaps::Pass& taps = passes_.taps.passes[index];
        const bool is_last = index + 1 == passes_.taps.passes.size();
        const GraphTexture one = from.forward ? from.forward : from.backward;
        const GraphShape shape = graph_.shape(one);
        const int reach = taps.stride * (static_cast<int>(taps.weights.size()) - 1);
        GraphPass pass = new_pass(fmt::format("pass {}", index + 1), shape.scale, spread(shape.region, line_, reach));
        ShaderDefines defines = line_defines();
        defines["TAPS"] = std::to_string(taps.weights.size());
        if (from.forward) {
            defines["FORWARD"] = "1";
            pass.reads.push_back({from.forward, reach});
        }
        if (from.backward) {
            defines["BACKWARD"] = "1";
            if (from.backward.id != from.forward.id) pass.reads.push_back({from.backward, reach});
        }
        const bool both = from.forward && from.backward;
        if (is_last) {
            defines["LAST"] = "1";
            pass.reads.push_back({source});
        } else if (both) {
            pass.writes.push_back(pass.writes.front());
        }
        const double all = passes_.taps.gain - passes_.source_too_much;
        const auto streak_share = static_cast<float>(passes_.weight * passes_.taps.gain / all);
        const auto source_share =
            static_cast<float>(-passes_.weight * passes_.source_too_much / all * line_.directions());
        Program& program = shaders_.full_screen("effects/streaks/streak.frag", defines);
        pass.draw = [&program, from, source, taps, slope = line_.slope, streak_share, source_share,
                     is_last](PassRun& run) {
            program.use();
            if (from.forward) run.bind(program, "forward", 0, from.forward);
            if (from.backward) run.bind(program, "backward", 1, from.backward);
            if (is_last) run.bind(program, "source", 2, source);
            program.set("weights", std::span<const float>(taps.weights));
            program.set("stride", taps.stride);
            program.set("slope", slope);
            program.set("streak_share", streak_share);
            program.set("source_share", source_share);
            run.draw(program);
        };
        const std::vector<GraphTexture> made = graph_.add_pass(std::move(pass));
        if (made.size() == 2) return {made[0], made[1]};
        return from.forward ? Streaks{made[0], {}} : Streaks{{}, made[0]};
    }

private:
    GraphPass new_pass(const std::string& step, int scale, const Region& region) const {
        GraphPass pass;
        pass.name = fmt::format("{} {}", passes_.name, step);
        pass.writes = {passes_.full_float ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F}};
        pass.scale = scale;
        pass.region = region.intersected(passes_.bounds);
        pass.beyond_frame = true;
        pass.needs = passes_.needs;
        return pass;
    }
    ShaderDefines line_defines() const {
        ShaderDefines defines{{"MAJOR", line_.is_steep ? "y" : "x"}, {"MINOR", line_.is_steep ? "x" : "y"}};
        if (line_.is_whole()) defines["WHOLE"] = std::to_string(static_cast<int>(line_.slope));
        return defines;
    }

    RenderGraph& graph_;
    ShaderLibrary& shaders_;
    const StreakLine& line_;
    const StreakPasses& passes_;
};

}  // namespace

double StreakLine::length_of_step() const {
    return std::hypot(1, slope);
}

bool StreakLine::is_whole() const {
    return slope == 0 || std::abs(slope) == 1;
}

std::vector<StreakLine> streak_lines(const std::vector<double>& angles) {
    std::vector<StreakLine> lines;
    for (const double angle : angles) {
        const double right = std::cos(angle), down = -std::sin(angle);
        const bool is_steep = std::abs(down) > std::abs(right) * (1 + 1e-9);
        const double major = is_steep ? down : right, minor = is_steep ? right : down;
        // Angles such as 45° give whole slopes but for rounding.
        const double slope = minor / major, nearest = std::round(slope);
        const double kept = std::abs(slope - nearest) < 1e-9 ? nearest : slope;
        const auto same = std::find_if(lines.begin(), lines.end(), [&](const StreakLine& line) {
            return line.is_steep == is_steep && std::abs(line.slope - kept) < 1e-9 &&
                   !(major > 0 ? line.forward : line.backward);
        });
        if (same == lines.end()) {
            lines.push_back({is_steep, kept, major > 0, major <= 0});
        } else {
            (major > 0 ? same->forward : same->backward) = true;
        }
    }
    return lines;
}

StreakTaps StreakTaps::of_length(double length, double attenuation, int most_taps) {
    assert(length > 0 && attenuation >= 0 && attenuation < 1);
    StreakTaps taps;
    int stride = 1;
    while (length / stride > most_taps) {
        taps.passes.push_back(pass_of(stride, 4, 1, attenuation, taps.gain));
        stride *= 4;
    }
    const int last = std::max(1, static_cast<int>(std::ceil(length / stride)));
    taps.passes.push_back(pass_of(stride, last, length / stride - (last - 1), attenuation, taps.gain));
    return taps;
}

double StreakTaps::source_too_much(double attenuation) {
    // Over tap i the exponential's mean is attenuation^i · (a^-½ − a^½)/λ, over the source's own half (1 − a^½)/λ.
    // Where nearly all light stays with its source, both are what rounding leaves of them.
    constexpr double least = 1e-3;
    const double root = std::sqrt(attenuation);
    return attenuation < least ? 0 : 1 - root / (1 + root);
}

StreakTaps StreakTaps::of_passes(int passes, double attenuation) {
    StreakTaps taps;
    for (int p = 0, stride = 1; p < passes; ++p, stride *= 4) {
        taps.passes.push_back(pass_of(stride, 4, 1, attenuation, taps.gain));
    }
    return taps;
}

GraphTexture add_streaks_along(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture light, const StreakLine& line,
                               const StreakPasses& passes) {
    LinePasses made(graph, shaders, line, passes);
    const GraphTexture source = made.add_shifted(light);
    LinePasses::Streaks streaks{line.forward ? source : GraphTexture{}, line.backward ? source : GraphTexture{}};
    for (std::size_t i = 0; i < passes.taps.passes.size(); ++i) streaks = made.add_pass(streaks, i, source);
    return streaks.forward ? streaks.forward : streaks.backward;
}

}  // namespace matchlight
