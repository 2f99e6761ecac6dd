// Throws, which C cannot do.
extern "C" __attribute__((visibility("hidden"))) void throw_something() { throw 1; }
