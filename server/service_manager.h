// Tells the service manager that started this process (systemd: Type=notify) how far it is.
#pragma once

#include <string_view>

namespace linetree {

// Sends `state`, such as "READY=1" or "STOPPING=1", to the socket that the environment names in
// NOTIFY_SOCKET (sd_notify(3)). Does nothing when it names none; never waits.
void NotifyServiceManager(std::string_view state);

}  // namespace linetree
