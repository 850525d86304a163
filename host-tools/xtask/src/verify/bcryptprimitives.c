/* Rust's standard library takes random numbers from this DLL of Windows. Wine has it from 9.0 on. */
#include <windows.h>

/* `RtlGenRandom`, under the name that advapi32 exports. */
BOOLEAN NTAPI SystemFunction036(PVOID buffer, ULONG length);

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE buffer, SIZE_T length)
{
    return SystemFunction036(buffer, (ULONG)length);
}
