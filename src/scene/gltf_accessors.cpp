// Bounds and contents of glTF accessors.
#include "scene/gltf_accessors.h"

#include <algorithm>
#include <cstring>
#include <map>

#include <fmt/format.h>

#include "core/memory.h"

namespace matchlight {
namespace {

using nlohmann::json;

/// GL counts vertices in 32 bits; no model that fits into memory comes near.
constexpr std::uint64_t most_elements = 1u << 28;

/// A component type as read; 0 for what is none.
int type_of(std::uint64_t number) {
    return number <= 5126 ? static_cast<int>(number) : 0;
}

int component_bytes(int type) {
    switch (type) {
        case 5120:
        case 5121:
            return 1;
        case 5122:
        case 5123:
            return 2;
        case 5125:
        case 5126:
            return 4;
        default:
            return 0;
    }
}

bool is_unsigned(int type) {
    return type == 5121 || type == 5123 || type == 5125;
}

template <class T>
T loaded(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

float float_of(const char* bytes, int type, bool normalized) {
    switch (type) {
        case 5120: {
            const float value = loaded<std::int8_t>(bytes);
            return normalized ? std::max(value / 127, -1.0f) : value;
        }
        case 5121: {
            const float value = loaded<std::uint8_t>(bytes);
            return normalized ? value / 255 : value;
        }
        case 5122: {
            const float value = loaded<std::int16_t>(bytes);
            return normalized ? std::max(value / 32767, -1.0f) : value;
        }
        case 5123: {
            const float value = loaded<std::uint16_t>(bytes);
            return normalized ? value / 65535 : value;
        }
        case 5125:
            return static_cast<float>(loaded<std::uint32_t>(bytes));
        default:
            return loaded<float>(bytes);
    }
}

std::uint32_t unsigned_of(const char* bytes, int type) {
    switch (type) {
        case 5121:
            return loaded<std::uint8_t>(bytes);
        case 5123:
            return loaded<std::uint16_t>(bytes);
        default:
            return loaded<std::uint32_t>(bytes);
    }
}

}  // namespace

GltfAccessors::GltfAccessors(const GltfDocument& document) : document_(document) {
    for (std::size_t i = 0; i < document.list("bufferViews").size(); ++i) {
        const std::string where = place_in("bufferViews", i);
        const json& source = document.item("bufferViews", i);
        GltfBufferView view;
        const auto buffer = document.index_of(source, "buffer", "buffers", where);
        if (!buffer) document.fail(where + ".buffer is missing");
        view.buffer = *buffer;
        view.offset = document.unsigned_of(source, "byteOffset", where, 0);
        view.length = document.unsigned_of(source, "byteLength", where);
        view.stride = document.unsigned_of(source, "byteStride", where, 0);
        const std::uint64_t size = document.buffers()[view.buffer].size();
        if (view.offset > size || view.length > size - view.offset) {
            document.fail(fmt::format("{} (bytes {} to {}) reaches beyond its buffer of {} bytes", where, view.offset,
                                      view.offset + view.length, size));
        }
        if (view.stride > 252) document.fail(where + ".byteStride is above 252");
        views_.push_back(view);
    }
    for (std::size_t i = 0; i < document.list("accessors").size(); ++i) accessors_.push_back(read_accessor(i));
}

GltfAccessor GltfAccessors::read_accessor(std::size_t number) const {
    static const std::map<std::string, int> component_counts = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                                {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
    const std::string where = place_in("accessors", number);
    const json& source = document_.item("accessors", number);
    GltfAccessor accessor;
    accessor.view = document_.index_of(source, "bufferView", "bufferViews", where);
    accessor.offset = document_.unsigned_of(source, "byteOffset", where, 0);
    accessor.count = document_.unsigned_of(source, "count", where);
    accessor.component_type = type_of(document_.unsigned_of(source, "componentType", where));
    const auto components = component_counts.find(document_.text_of(source, "type", where));
    if (components == component_counts.end()) document_.fail(where + ".type is unknown");
    if (component_bytes(accessor.component_type) == 0) document_.fail(where + ".componentType is unknown");
    accessor.components = components->second;
    const auto normalized = source.find("normalized");
    accessor.normalized = normalized != source.end() && normalized->is_boolean() && normalized->get<bool>();

    const auto element_bytes =
        static_cast<std::uint64_t>(component_bytes(accessor.component_type) * accessor.components);
    if (accessor.count == 0) document_.fail(where + ".count is 0");
    if (accessor.count > most_elements || accessor.count * element_bytes > available_memory_bytes()) {
        document_.fail(fmt::format("{}.count is {}: that does not fit into memory", where, accessor.count));
    }
    if (accessor.view) check_span(*accessor.view, accessor.offset, accessor.count, element_bytes, where);

    if (source.contains("sparse")) {
        const json& sparse = source["sparse"];
        const std::string sparse_where = where + ".sparse";
        if (!sparse.is_object() || !sparse.contains("indices") || !sparse["indices"].is_object() ||
            !sparse.contains("values") || !sparse["values"].is_object()) {
            document_.fail(sparse_where + " has no indices and values");
        }
        const json& indices = sparse["indices"];
        const json& values = sparse["values"];
        GltfAccessor::Sparse part;
        part.count = document_.unsigned_of(sparse, "count", sparse_where);
        if (part.count > accessor.count) document_.fail(sparse_where + ".count is above the accessor's");
        const auto index_view = document_.index_of(indices, "bufferView", "bufferViews", sparse_where + ".indices");
        const auto value_view = document_.index_of(values, "bufferView", "bufferViews", sparse_where + ".values");
        if (!index_view || !value_view) document_.fail(sparse_where + " has no bufferView");
        part.index_view = *index_view;
        part.value_view = *value_view;
        part.index_offset = document_.unsigned_of(indices, "byteOffset", sparse_where, 0);
        part.value_offset = document_.unsigned_of(values, "byteOffset", sparse_where, 0);
        part.index_type = type_of(document_.unsigned_of(indices, "componentType", sparse_where));
        if (!is_unsigned(part.index_type)) document_.fail(sparse_where + ".indices.componentType is not unsigned");
        const auto index_bytes = static_cast<std::uint64_t>(component_bytes(part.index_type));
        check_span(part.index_view, part.index_offset, part.count, index_bytes, sparse_where + ".indices");
        check_span(part.value_view, part.value_offset, part.count, element_bytes, sparse_where + ".values");
        for (std::uint64_t i = 0; i < part.count; ++i) {
            const char* bytes = bytes_of(part.index_view, part.index_offset + i * index_bytes);
            const std::uint32_t index = unsigned_of(bytes, part.index_type);
            if (index >= accessor.count) {
                document_.fail(
                    fmt::format("{}: index {} is beyond the {} elements", sparse_where, index, accessor.count));
            }
        }
        accessor.sparse = part;
    }
    return accessor;
}

void GltfAccessors::check_span(std::size_t view_number, std::uint64_t offset, std::uint64_t count,
                               std::uint64_t element_bytes, const std::string& where) const {
    const GltfBufferView& view = views_[view_number];
    const std::uint64_t stride = view.stride == 0 ? element_bytes : view.stride;
    if (stride < element_bytes) document_.fail(where + ": the buffer view's byteStride is below the element's size");
    // All terms are below 2^53, and stride · count below 2^36.
    const std::uint64_t end = count == 0 ? offset : offset + (count - 1) * stride + element_bytes;
    if (end > view.length) {
        document_.fail(
            fmt::format("{}: {} elements end at byte {} of a buffer view of {}", where, count, end, view.length));
    }
}

const char* GltfAccessors::bytes_of(std::size_t view, std::uint64_t offset) const {
    return document_.buffers()[views_[view].buffer].data() + views_[view].offset + offset;
}

/// `convert` makes a Value of a component's bytes.
template <class Value, class Convert>
std::vector<Value> GltfAccessors::read(const GltfAccessor& accessor, const Convert& convert) const {
    const auto components = static_cast<std::uint64_t>(accessor.components);
    const auto component_size = static_cast<std::uint64_t>(component_bytes(accessor.component_type));
    std::vector<Value> values(accessor.count * components);
    const auto read_element = [&](const char* bytes, std::uint64_t element) {
        for (std::uint64_t c = 0; c < components; ++c) {
            values[element * components + c] = convert(bytes + c * component_size);
        }
    };
    if (accessor.view) {
        const std::uint64_t packed = components * component_size;
        const std::uint64_t stride = views_[*accessor.view].stride == 0 ? packed : views_[*accessor.view].stride;
        for (std::uint64_t i = 0; i < accessor.count; ++i) {
            read_element(bytes_of(*accessor.view, accessor.offset + i * stride), i);
        }
    }
    if (accessor.sparse) {
        const GltfAccessor::Sparse& sparse = *accessor.sparse;
        const auto index_bytes = static_cast<std::uint64_t>(component_bytes(sparse.index_type));
        for (std::uint64_t i = 0; i < sparse.count; ++i) {
            const char* index = bytes_of(sparse.index_view, sparse.index_offset + i * index_bytes);
            read_element(bytes_of(sparse.value_view, sparse.value_offset + i * components * component_size),
                         unsigned_of(index, sparse.index_type));
        }
    }
    return values;
}

std::vector<float> GltfAccessors::floats(std::size_t number) const {
    const GltfAccessor& accessor = accessors_[number];
    return read<float>(
        accessor, [&](const char* bytes) { return float_of(bytes, accessor.component_type, accessor.normalized); });
}

std::vector<std::uint32_t> GltfAccessors::indices(std::size_t number) const {
    const GltfAccessor& accessor = accessors_[number];
    if (accessor.components != 1 || !is_unsigned(accessor.component_type)) {
        document_.fail(place_in("accessors", number) + " is used as indices but holds no unsigned numbers");
    }
    return read<std::uint32_t>(accessor,
                               [&](const char* bytes) { return unsigned_of(bytes, accessor.component_type); });
}

bool GltfAccessors::is_plain(std::size_t number) const {
    const GltfAccessor& accessor = accessors_[number];
    if (!accessor.view || accessor.sparse) return false;
    const bool plain_type =
        accessor.component_type == 5126 || (accessor.components == 1 && is_unsigned(accessor.component_type));
    // assimp 5.2 asks for room for a whole stride after the last element too.
    const GltfBufferView& view = views_[*accessor.view];
    return plain_type && accessor.count * view.stride <= view.length;
}

}  // namespace matchlight
