// What the helping threads beside the loop are.
#pragma once

namespace pneuservo {

/// The calling thread gets ordinary priority, a name (15 characters at most) and no signals but those of a crash: the
/// others are the loop's. A thread inherits all this from the one that starts it, and none may compete with the loop.
void become_ordinary_thread(const char* name) noexcept;

}  // namespace pneuservo
