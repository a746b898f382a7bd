// The passes along one line of streaks, for both ways that light runs along it.
#pragma once

#include <vector>

#include "gl/shader_library.h"
#include "render/graph.h"

namespace matchlight {

/// A slanted line on a grid of texels. `slope` is what its minor axis gains per texel of the major one: at most 1.
struct StreakLine {
    bool is_steep = false;  // the major axis runs down, not across
    double slope = 0;
    bool forward = false;   // a streak towards larger major coordinates
    bool backward = false;  // … and one towards smaller ones

    int directions() const { return static_cast<int>(forward) + static_cast<int>(backward); }
    /// Texels that light moves along the line for each one along its major axis.
    double length_of_step() const;
    /// Whether its texels lie on the grid's own.
    bool is_whole() const;
};

/// Angles (radians, counter-clockwise, y down on the grid) that are opposite share a line.
std::vector<StreakLine> streak_lines(const std::vector<double>& angles);

/// Weights of Kawase's passes, each of unit sum.
struct StreakTaps {
    struct Pass {
        int stride = 1;
        std::vector<float> weights;
    };
    std::vector<Pass> passes;
    double gain = 1;  // the sum of all weights as they were, the first of each pass 1

    /// Taps for a streak of `length` steps, each step weaker by `attenuation`; from `most_taps` on it takes another
    /// pass.
    static StreakTaps of_length(double length, double attenuation, int most_taps);
    /// With tap i the mean of the exponential from i − ½ to i + ½: what the source's own, from 0 to ½, has less than 1.
    static double source_too_much(double attenuation);
    /// Kawase's own: passes of four taps each.
    static StreakTaps of_passes(int passes, double attenuation);
};

struct StreakPasses {
    StreakTaps taps;
    Region bounds;  // nothing is drawn outside of it
    double weight = 1;
    /// Of the source's own tap, what is taken away: it stands for half a texel, before which there is no streak.
    double source_too_much = 0;
    bool full_float = false;
    const GpuCondition* needs = nullptr;
    std::string name;
};

/// weight · the sum of the line's streaks of `light`, each of unit sum, along the line's own rows
/// (StreakLine::is_whole: the texture's).
GraphTexture add_streaks_along(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture light, const StreakLine& line,
                               const StreakPasses& passes);

}  // namespace matchlight
