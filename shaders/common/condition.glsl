// A condition on the GPU (gl/condition.h): the vertex count of an indirect draw.
layout(std430, binding = 7) buffer Condition {
    uint vertices, instances, first_vertex, first_instance;
} condition;

// Every invocation that finds it met writes the same value: no atomic is needed.
void meet_condition() { condition.vertices = 3u; }
bool condition_is_met() { return condition.vertices != 0u; }
