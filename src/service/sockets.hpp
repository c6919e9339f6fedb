// Sockets of the service: listening, connecting, and who is at the other end.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "service/descriptor.hpp"

namespace pneuservo {

/// A Unix socket that its owner and group may use. A name that a dead program left is taken over. Throws InputError
/// where another program answers there, something else than a socket has the name, or it cannot be made.
Descriptor listen_at(const std::filesystem::path& path);
/// TCP on 127.0.0.1 alone. Throws InputError.
Descriptor listen_on_loopback(std::uint16_t port);
/// Both throw InputError where nobody answers.
Descriptor connect_to(const std::filesystem::path& path);
Descriptor connect_to_loopback(std::uint16_t port);

/// "process 1234", or "127.0.0.1:40000".
std::string peer_name(int descriptor);

/// Where the socket of an axis is made: $RUNTIME_DIRECTORY of a service, or $XDG_RUNTIME_DIR/pneuservo of a person.
/// Throws InputError where there is neither.
std::filesystem::path socket_folder();
/// The sockets of all axes that this account can see, in /run/pneuservo and $XDG_RUNTIME_DIR/pneuservo.
std::vector<std::filesystem::path> seen_sockets();

}  // namespace pneuservo
