#version 450 core
// Only depth is kept.

void main() {}
