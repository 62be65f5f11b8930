/* Windows' bcryptprimitives.dll for Wine before version 9, which has none: Rust's standard library takes the seeds of its hash tables
   from it. For flights in Wine only; no archive carries it. Without a C library, so that it builds at once. */

unsigned char __stdcall SystemFunction036(void *buffer, unsigned long length);

int __stdcall DllMain(void *module, unsigned long reason, void *reserved) {
    (void)module, (void)reason, (void)reserved;
    return 1;
}

__declspec(dllexport) int __stdcall ProcessPrng(unsigned char *buffer, unsigned long long length) {
    return SystemFunction036(buffer, (unsigned long)length);
}
