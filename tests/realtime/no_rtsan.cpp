// The hooks of RealtimeSanitizer in programs that are watched by other means.
extern "C" {
void __rtsan_realtime_enter() {}
void __rtsan_realtime_exit() {}
void __rtsan_off() {}
void __rtsan_on() {}
}
