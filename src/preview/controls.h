// The controls of the panels, each under a name that scripts set it by and tests find its place by.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"

namespace matchlight {

/// A control as it was laid out last.
struct LaidOutControl {
    std::string name;
    Region place;  // pixels of the window
    Region seen;   // what of it is not cut off
    bool clipped_text = false;
};

struct NumberControl {
    double lowest = 0, highest = 1;
    bool logarithmic = false;
    bool whole = false;  // numbers only
    bool slides = true;  // from end to end; false: by as much as it is dragged
};

/// Each call lays out a control and returns whether it was changed: by hand, or by what a script set under its name.
class Controls {
public:
    /// Before the controls of a frame.
    void begin_frame();

    bool button(const std::string& name, const char* text, const char* tooltip = nullptr);
    /// A square without looks of its own.
    bool area(const std::string& name, float side);
    /// A button that stays down.
    bool toggle(const std::string& name, const char* text, bool& on, const char* tooltip = nullptr);
    /// Of a list, as wide as it is.
    bool row(const std::string& name, const char* text, bool chosen);
    bool checkbox(const std::string& name, const char* text, bool& on, const char* tooltip = nullptr);
    bool number(const std::string& name, const char* text, double& value, const NumberControl& range,
                const char* tooltip = nullptr);
    bool choice(const std::string& name, const char* text, std::size_t& index, std::span<const std::string_view> words,
                const char* tooltip = nullptr);
    /// Three numbers, dragged each.
    bool vector(const std::string& name, const char* text, double (&xyz)[3], const NumberControl& range,
                const char* tooltip = nullptr);
    bool color(const std::string& name, const char* text, float (&rgb)[3], const char* tooltip = nullptr);
    bool text(const std::string& name, const char* label, std::string& value, const char* tooltip = nullptr);

    /// What the control of that name becomes when it is laid out next.
    void set(const std::string& name, const std::string& value);
    /// The name that was set and not found, after a frame in which it was to be; and forgets it.
    std::optional<std::string> take_unfound();
    bool has_set() const { return set_.has_value(); }

    const std::vector<LaidOutControl>& laid_out() const { return laid_out_; }
    /// The place of a control of the last frame.
    const LaidOutControl* find(const std::string& name) const;
    /// Whether a control was being changed by hand in this frame.
    bool is_held() const { return held_; }

private:
    struct SetValue {
        std::string name, value;
    };
    std::optional<std::string> set_for(const std::string& name);
    /// Whether a script changed the switch.
    bool switched(const std::string& name, bool& on);
    void note(const std::string& name, const char* text, const char* tooltip);

    std::vector<LaidOutControl> laid_out_, before_;
    std::optional<SetValue> set_;
    bool held_ = false;
};

/// "on", "yes" and "true", or "off", "no" and "false"; nullopt for anything else.
std::optional<bool> switch_word(std::string_view word);
/// The whole of it as a finite number.
std::optional<double> number_word(std::string_view word);

}  // namespace matchlight
