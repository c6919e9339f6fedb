// What the planted violations and the clean step of the guard programs do, each by its name.
#pragma once
#include <string_view>

/// Calls the violation of that name once inside the real-time section; false if there is no such name.
/// Names: clean, new, malloc, vector, throw, mutex, contended_mutex, usleep, write, clock_nanosleep, fresh_pages.
bool guarded_step(std::string_view name);

/// Prepares what a violation needs (a held mutex, an unmapped page) outside the section.
void prepare_step(std::string_view name);
