// Reads a scene file by the schema, then checks what only several settings together can tell.
#include "scene/scene_file.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "core/error.h"
#include "scene/lamp_schema.h"
#include "scene/scene_edit.h"
#include "scene/scene_schema.h"
#include "scene/setting_reader.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

/// Number of tags in each family (AprilTag 3's code tables).
const std::map<std::string, int, std::less<>> family_sizes = {
    {"tag36h11", 587}, {"tag25h9", 35}, {"tag16h5", 30}, {"tagStandard41h12", 2115}, {"tagCircle21h7", 38}};

/// Calls `visit` with a table, or with each table of an array.
template <class Visit>
void for_each_table(const toml::node& node, const Visit& visit) {
    if (const toml::table* table = node.as_table()) visit(*table);
    if (const toml::array* array = node.as_array()) {
        for (const toml::node& item : *array) {
            if (const toml::table* table = item.as_table()) visit(*table);
        }
    }
}

class SceneReader {
public:
    SceneReader(SceneSource source, Warnings& warnings) : source_(std::move(source)), warnings_(warnings) {}

    Scene read(const toml::table& root) {
        scene_.path = source_.path;
        check_sections(root);
        check_kind_of_scene(root);
        for (const SceneSection& section : scene_sections()) read_section_of_root(root, section);
        if (const toml::node* background = root.get("background")) check_background(*background);
        check_color(root);
        check_exposure(root);
        check_focus(root);
        check_effects(root);
        scene_.effective_toml = std::move(effective_);
        return std::move(scene_);
    }

private:
    void check_sections(const toml::table& root);
    void check_kind_of_scene(const toml::table& root);
    void read_section_of_root(const toml::table& root, const SceneSection& section);
    /// Reads every setting of a section and returns them, defaults included, as lines of TOML.
    std::vector<std::string> read_table(const SceneSection& section, const toml::table& table);
    std::optional<std::string> read_value(const Setting& setting, const toml::node& node);
    void check_keys(const SceneSection& section, const toml::table& table);

    void read_lights(const SceneSection& probe_section, const toml::array& lights);
    void check_tag(const toml::table& table);
    void check_object(const toml::table& table);
    void check_spheres(const toml::table& table);
    void check_material(const toml::table& table);
    void check_camera(const toml::table& table);
    void check_background(const toml::node& node);
    void check_color(const toml::table& root);
    void check_exposure(const toml::table& root);
    void check_focus(const toml::table& root);
    void check_effects(const toml::table& root);

    void append(std::string_view header, const std::vector<std::string>& lines) {
        if (!effective_.empty()) effective_ += "\n";
        effective_ += fmt::format("{}\n{}\n", header, fmt::join(lines, "\n"));
    }

    SceneSource source_;
    Warnings& warnings_;
    Scene scene_;
    std::string effective_;
};

void SceneReader::check_sections(const toml::table& root) {
    std::vector<std::string_view> known;
    for (const SceneSection& section : scene_sections()) {
        if (section.use != SectionUse::nested) known.push_back(section.name);
    }
    for (const auto& [key, node] : root) {
        const SceneSection* section = find_section(key);
        if (section == nullptr || section->use == SectionUse::nested) {
            source_.fail(key, fmt::format("unknown section '{}'", std::string_view(key)),
                         fmt::format("did you mean '{}'?", nearest_word(key, known)));
        }
        if (section->name == "light" && node.is_table() && node.as_table()->contains("type")) {
            source_.fail(*node.as_table()->get("type"), "[light] is the probe alone, and has no type",
                         "write [[light]] for an analytic light");
        }
        // Before any value is read: a misspelt key is why another one is missing.
        const bool is_list_of_lights = section->name == "light" && node.is_array();
        for_each_table(node, [&](const toml::table& table) {
            const bool is_lamp = is_list_of_lights && !table.contains("probe");
            check_keys(is_lamp ? *find_section(lamp_section) : *section, table);
        });
    }
}

/// Footage and its tags, or a camera and its background.
void SceneReader::check_kind_of_scene(const toml::table& root) {
    const toml::node* footage = root.get("footage");
    const toml::node* camera = root.get("camera");
    if (footage != nullptr && camera != nullptr) {
        source_.fail(*camera, "[camera] belongs to scenes without footage, and this one has [footage]",
                     "leave one of them out");
    }
    if (footage == nullptr && camera == nullptr) {
        source_.fail(root, "the scene has neither footage nor a camera",
                     "give [footage] with video and camera, or [camera] with width and height");
    }
    const toml::node* background = root.get("background");
    if (footage != nullptr && background != nullptr) {
        source_.fail(*background, "[background] belongs to scenes without footage, and this one has [footage]",
                     "leave it out");
    }
}

void SceneReader::read_section_of_root(const toml::table& root, const SceneSection& section) {
    if (section.use == SectionUse::nested) return;
    const toml::node* node = root.get(section.name);
    if (section.use == SectionUse::repeated) {
        if (node == nullptr) return;
        const toml::array* array = node->as_array();
        if (array == nullptr) {
            source_.fail(*node, fmt::format("[{0}] is a list: write [[{0}]]", section.name));
        }
        for (const toml::node& item : *array) {
            if (!item.is_table()) source_.fail(item, fmt::format("[[{}]] is a table of settings", section.name));
            append(fmt::format("[[{}]]", section.name), read_table(section, *item.as_table()));
        }
        return;
    }
    const bool needed = section.name == "tags" && root.contains("footage");  // they are what footage is tracked by
    if (node == nullptr && section.use == SectionUse::optional && !needed) return;
    static const toml::table nothing;
    const toml::table* table = node == nullptr ? &nothing : node->as_table();
    if (node == nullptr && section.name == "surface" && scene_.camera) {
        static const toml::table no_surface{{"enabled", false}};
        table = &no_surface;
    }
    if (section.name == "light" && node->is_array()) return read_lights(section, *node->as_array());
    if (table == nullptr) source_.fail(*node, fmt::format("[{}] is a table of settings", section.name));
    append(fmt::format("[{}]", section.name), read_table(section, *table));
}

/// The lamps and, at most once, a probe.
void SceneReader::read_lights(const SceneSection& probe_section, const toml::array& lights) {
    if (lights.empty()) source_.fail(lights, "[light] is a table of settings");
    for (const toml::node& item : lights) {
        const toml::table* table = item.as_table();
        if (table == nullptr) source_.fail(item, "[[light]] is a table of settings");
        if (table->contains("probe") && scene_.probe) source_.fail(item, "[[light]]: a scene has one probe");
        const bool is_lamp = !table->contains("probe");
        append("[[light]]", read_table(is_lamp ? *find_section(lamp_section) : probe_section, *table));
        if (is_lamp) check_lamp(source_, scene_.lamps.back(), *table);
    }
    if (scene_.lamps.size() > most_lamps) {
        source_.fail(lights, fmt::format("the scene has {} analytic lights, and {} are the most", scene_.lamps.size(),
                                         most_lamps));
    }
    for (LampSettings& lamp : scene_.lamps) lamp.in_footage = lamp.in_footage.value_or(!scene_.probe);
}

void SceneReader::check_keys(const SceneSection& section, const toml::table& table) {
    std::vector<std::string_view> known;
    for (const Setting& setting : scene_settings()) {
        if (setting.section == section.name) known.push_back(setting.key);
    }
    for (const auto& [key, node] : table) {
        const std::string_view word = key;
        if (std::find(known.begin(), known.end(), word) != known.end()) {
            const SceneSection* nested = find_section(fmt::format("{}.{}", section.name, word));
            if (nested == nullptr) continue;
            for_each_table(node, [&](const toml::table& inner) { check_keys(*nested, inner); });
            continue;
        }
        std::string cure = fmt::format("did you mean '{}'?", nearest_word(word, known));
        for (const Setting& setting : scene_settings()) {
            if (setting.key != word) continue;
            cure = setting.section == lamp_section ? "it belongs in an entry of [[light]] that has a type"
                                                   : fmt::format("it belongs in [{}]", setting.section);
        }
        source_.fail(key, fmt::format("unknown key '{}' in [{}]", word, written_section(section.name)), cure);
    }
}

std::vector<std::string> SceneReader::read_table(const SceneSection& section, const toml::table& table) {
    if (section.begin != nullptr) section.begin(scene_);
    std::vector<std::string> lines;
    for (const Setting& setting : scene_settings()) {
        if (setting.section != section.name) continue;
        const toml::node* node = table.get(setting.key);
        if (node != nullptr) {
            if (const auto text = read_value(setting, *node))
                lines.push_back(fmt::format("{} = {}", setting.key, *text));
        } else if (setting.fallback == must_be_given) {
            source_.fail(table, fmt::format("'{}' is missing in [{}]: {}", setting.key, written_section(section.name),
                                            setting.help));
        } else if (!setting.fallback.empty()) {
            const toml::table fallback = toml::parse(fmt::format("value = {}", setting.fallback));
            if (setting.domain.kind == SettingKind::effect) {
                lines.push_back(fmt::format("{} = {}", setting.key, *read_value(setting, *fallback.get("value"))));
                continue;
            }
            if (setting.set != nullptr) setting.set(scene_, read_setting(source_, setting, *fallback.get("value")));
            lines.push_back(fmt::format("{} = {}", setting.key, setting.fallback));
        }
    }
    if (section.name == "tags.rig") check_tag(table);
    if (section.name == "object") check_object(table);
    if (section.name == "object.material") check_material(table);
    if (section.name == "camera") check_camera(table);
    return lines;
}

/// The value as TOML; nullopt where the setting is known but left out.
std::optional<std::string> SceneReader::read_value(const Setting& setting, const toml::node& node) {
    const auto nested = [&](const toml::node& item) {
        const toml::table* table = item.as_table();
        if (table == nullptr) {
            source_.fail(item, fmt::format("'{}' in [{}] holds tables of settings", setting.key, setting.section));
        }
        const SceneSection* section = find_section(fmt::format("{}.{}", setting.section, setting.key));
        assert(section != nullptr);
        return fmt::format("{{{}}}", fmt::join(read_table(*section, *table), ", "));
    };
    switch (setting.domain.kind) {
        case SettingKind::section:
            return nested(node);
        case SettingKind::sections: {
            const toml::array* array = node.as_array();
            if (array == nullptr || array->empty()) {
                source_.fail(node, fmt::format("'{}' in [{}] is a list of at least one entry: {}", setting.key,
                                               setting.section, setting.help));
            }
            std::vector<std::string> items;
            for (const toml::node& item : *array) items.push_back(nested(item));
            return fmt::format("[{}]", fmt::join(items, ", "));
        }
        case SettingKind::effect: {
            if (node.is_table()) return nested(node);
            const bool off = node.value_exact<std::string>() == "off" || node.value_exact<bool>() == false;
            if (off) {
                if (setting.set != nullptr) setting.set(scene_, {});
                return "\"off\"";
            }
            const bool automatic = node.value_exact<std::string>() == "auto" || node.value_exact<bool>() == true;
            if (!automatic) {
                source_.fail(node, fmt::format("'{}' in [{}] is {}", setting.key, setting.section, toml_text(node)),
                             "give \"off\", \"auto\" or a table of its settings");
            }
            static const toml::table defaults;
            return nested(defaults);
        }
        case SettingKind::left_out: {
            const bool off = node.value_exact<std::string>() == "off" || node.value_exact<bool>() == false;
            if (!off) {
                warnings_.add(fmt::format("{}:{}: '{}' in [{}]: not available in this version, left out",
                                          source_.path.string(), node.source().begin.line, setting.key,
                                          setting.section));
            }
            return setting.fallback.empty() ? std::nullopt : std::optional(std::string(setting.fallback));
        }
        case SettingKind::not_built:
            source_.fail(node, fmt::format("'{}' in [{}]: this version cannot do it ({})", setting.key, setting.section,
                                           setting.help));
        default:
            setting.set(scene_, read_setting(source_, setting, node));
            return toml_text(node);
    }
}

void SceneReader::check_tag(const toml::table& table) {
    const RigTag& tag = scene_.tags.rig.back();
    const toml::node& id = *table.get("id");
    for (std::size_t i = 0; i + 1 < scene_.tags.rig.size(); ++i) {
        if (scene_.tags.rig[i].id == tag.id) source_.fail(id, fmt::format("the rig has the tag {} twice", tag.id));
    }
    const int family_size = family_sizes.at(scene_.tags.family);
    if (tag.id >= family_size) {
        source_.fail(id,
                     fmt::format("there is no tag {} in {} (0 to {})", tag.id, scene_.tags.family, family_size - 1));
    }
}

void SceneReader::check_object(const toml::table& table) {
    ObjectSettings& object = scene_.objects.back();
    const int given =
        (object.model.empty() ? 0 : 1) + (object.shape.empty() ? 0 : 1) + (object.spheres.empty() ? 0 : 1);
    if (given != 1) {
        source_.fail(table,
                     fmt::format("[[object]] {} has {} of model, shape and spheres", scene_.objects.size(),
                                 given == 0 ? "none" : "more than one"),
                     "give one");
    }
    check_spheres(table);
    if (object.parent_tag) {
        const bool known = std::any_of(scene_.tags.rig.begin(), scene_.tags.rig.end(),
                                       [&](const RigTag& tag) { return tag.id == *object.parent_tag; });
        if (!known) {
            source_.fail(*table.get("parent_tag"),
                         fmt::format("the rig has no tag {} to be a parent", *object.parent_tag));
        }
    }
    const toml::array* keys = table["keys"].as_array();
    for (std::size_t i = 1; i < object.keys.size(); ++i) {
        if (object.keys[i].frame > object.keys[i - 1].frame) continue;
        source_.fail((*keys)[i],
                     fmt::format("keys of [[object]] {}: frame {} does not come after {}", scene_.objects.size(),
                                 object.keys[i].frame, object.keys[i - 1].frame),
                     "give each frame once, in ascending order");
    }
    if (object.spin && object.spin->axis.isZero(0)) {
        source_.fail(*table.get("spin"), "'axis' in [object.spin] has no direction", "give [0, 0, 1] for the vertical");
    }
    if (!object.name.empty()) return;
    // Layers need names of their own: the second "sphere" becomes "sphere 2".
    const std::string stem = !object.shape.empty()   ? object.shape
                             : !object.model.empty() ? object.model.stem().string()
                                                     : object.spheres.stem().string();
    const auto taken = [&](const std::string& name) {
        return std::any_of(scene_.objects.begin(), scene_.objects.end() - 1,
                           [&](const ObjectSettings& other) { return other.name == name; });
    };
    object.name = stem;
    for (int number = 2; taken(object.name); ++number) object.name = fmt::format("{} {}", stem, number);
}

void SceneReader::check_spheres(const toml::table& table) {
    const ObjectSettings& object = scene_.objects.back();
    if (object.spheres.empty()) {
        const toml::node* sphere = table.get("sphere");
        if (sphere != nullptr)
            source_.fail(*sphere, "'sphere' in [object] is of no use without spheres", "leave it out");
        return;
    }
    const auto is_even = [](const Eigen::Vector3d& scale) { return scale.x() == scale.y() && scale.y() == scale.z(); };
    const bool keys_are_even =
        std::ranges::all_of(object.keys, [&](const ObjectKey& key) { return is_even(key.scale); });
    if (is_even(object.scale) && keys_are_even) return;
    source_.fail(table,
                 fmt::format("'scale' of [[object]] {} differs from axis to axis, and spheres stay spheres",
                             scene_.objects.size()),
                 "give one number");
}

void SceneReader::check_material(const toml::table& table) {
    const SurfaceDetail& detail = scene_.objects.back().material.detail;
    if (detail.relief.depth_m > 0 && detail.relief.height_map.empty()) {
        source_.fail(*table.get("height"), "'height' in [object.material] carves nothing without a height_map",
                     "give height_map");
    }
    if (const toml::node* map = table.get("height_map"); map != nullptr && !table.contains("height")) {
        source_.fail(*map, "'height_map' in [object.material] needs to know how deep it is", "give height in metres");
    }
    if (!detail.pattern) return;
    const auto& direction = detail.pattern->direction;
    if (std::ranges::any_of(direction, [](double component) { return component != 0; })) return;
    source_.fail(*table.get("pattern"), "'direction' in [object.material.pattern] has no direction",
                 "give [1, 0, 0] for the x axis");
}

void SceneReader::check_camera(const toml::table& table) {
    const CameraSettings& camera = *scene_.camera;
    if (camera.orbit.has_value() == !camera.keys.empty()) {
        source_.fail(table, fmt::format("[camera] has {} of orbit and keys", camera.orbit ? "both" : "neither"),
                     "give one");
    }
    const toml::array* keys = table["keys"].as_array();
    for (std::size_t i = 0; i < camera.keys.size(); ++i) {
        const CameraKey& key = camera.keys[i];
        if (i > 0 && key.frame <= camera.keys[i - 1].frame) {
            source_.fail(
                (*keys)[i],
                fmt::format("keys of [camera]: frame {} does not come after {}", key.frame, camera.keys[i - 1].frame),
                "give each frame once, in ascending order");
        }
        if (key.eye_m == key.target_m) {
            source_.fail((*keys)[i],
                         fmt::format("keys of [camera]: at frame {} eye and target are one point", key.frame),
                         "look at another point");
        }
    }
}

void SceneReader::check_background(const toml::node& node) {
    const BackgroundSettings& background = scene_.background;
    const int given = (background.probe ? 1 : 0) + (background.color ? 1 : 0) + (background.image.empty() ? 0 : 1);
    if (given > 1) source_.fail(node, "[background] is more than one of probe, color and image", "give one");
    if (background.probe && !scene_.probe) {
        source_.fail(node, "[background] shows the probe, but the scene has none", "give [light] with a probe");
    }
}

void SceneReader::check_exposure(const toml::table& root) {
    const std::optional<ExposureSettings>& exposure = scene_.effects.exposure;
    if (!scene_.camera || !exposure || exposure->mode == ExposureMode::simulated) return;
    source_.fail(*root["effects"]["exposure"]["mode"].node(),
                 "'mode' in [effects.exposure] is matched, and the scene has no footage to match",
                 "give mode = \"simulated\", or leave exposure out and set exposure_ev in [camera]");
}

/// What the lens focuses on by itself must be there.
void SceneReader::check_focus(const toml::table& root) {
    const toml::table* table = root["effects"]["depth_of_field"].as_table();
    if (table == nullptr) return;
    const FocusTarget target = scene_.effects.depth_of_field->focus_on;
    const toml::node* focus_on = table->get("focus_on");
    const auto check = [&](FocusTarget named, const char* key) {
        const toml::node* node = table->get(key);
        if (target == named && node == nullptr) {
            source_.fail(*focus_on, fmt::format("'focus_on' in [effects.depth_of_field] is \"{0}\" without {0}", key),
                         fmt::format("give {}", key));
        }
        if (focus_on == nullptr && node != nullptr) {
            source_.fail(*node, fmt::format("'{}' in [effects.depth_of_field] does nothing without focus_on", key),
                         fmt::format("give focus_on = \"{}\"", key));
        }
    };
    check(FocusTarget::point, "point");
    check(FocusTarget::object, "object");
    if (target != FocusTarget::object) return;
    std::vector<std::string_view> names;
    for (const ObjectSettings& object : scene_.objects) names.push_back(object.name);
    const std::string& wanted = scene_.effects.depth_of_field->focus_object;
    if (std::ranges::find(names, wanted) != names.end()) return;
    source_.fail(
        *table->get("object"),
        fmt::format("'object' in [effects.depth_of_field]: the scene has no object '{}'", wanted),
        names.empty() ? "give it an [[object]]" : fmt::format("did you mean '{}'?", nearest_word(wanted, names)));
}

void SceneReader::check_color(const toml::table& root) {
    const toml::node_view<const toml::node> footage = root["footage"];
    if (const toml::node* config = footage["ocio_config"].node();
        config != nullptr && scene_.footage.ocio_space.empty()) {
        source_.fail(*config, "'ocio_config' in [footage] needs to know which of its spaces the footage is in",
                     "give ocio_space");
    }
    if (const toml::node* response = footage["response"].node();
        response != nullptr && !scene_.footage.ocio_space.empty()) {
        source_.fail(*response, "'response' in [footage] and 'ocio_space' both say the footage's curve",
                     "leave one of them out");
    }
}

/// What each effect says of its settings together.
void SceneReader::check_effects(const toml::table& root) {
    const auto check = [&](const char* key, const auto& settings, const char* cure) {
        const toml::node* node = root["effects"][key].node();
        if (node == nullptr || !settings) return;
        try {
            settings->check();
        } catch (const std::invalid_argument& error) {
            source_.fail(*node, fmt::format("'{}' in [effects]: {}", key, error.what()), cure);
        }
    };
    check("vignette", scene_.effects.vignette, "give smaller v1 or v2");
    check("depth_cue", scene_.effects.depth_cue, "give a far distance beyond the near one");
}

}  // namespace

Scene load_scene(const fs::path& path, Warnings& warnings) {
    return load_scene(SceneText::load(path), warnings);
}

Scene load_scene(const SceneText& text, Warnings& warnings) {
    const fs::path& path = text.path();
    Scene scene = SceneReader(SceneSource{path}, warnings).read(toml::parse(text.text()));
    if (scene.footage.solve.empty() && !scene.camera) {
        scene.footage.solve = path.parent_path() / (path.stem().string() + ".solve.json");
    }
    return scene;
}

}  // namespace matchlight
