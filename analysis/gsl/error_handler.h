// How GSL tells of errors. For the files of this folder, which alone include GSL's headers.
#pragma once

namespace springstab {

/// GSL's answer to an error is one handler for the whole process, which ends it unless set otherwise. The
/// first call, from whichever thread, switches the handler off for good: every function of this folder checks
/// the returned status instead. Nobody saves and restores the handler around a call, since two threads that
/// did would leave each other's. A program that wants a handler of its own sets it after the first use of
/// springstab::analysis, and gets springstab's errors there, too.
void use_error_statuses();

}  // namespace springstab
