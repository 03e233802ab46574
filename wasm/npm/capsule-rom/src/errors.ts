/** Why there is no answer: the core's words, and its name of the reason, such as "outside-domain". */
export class CapsuleError extends Error {
  override readonly name = "CapsuleError";
  readonly code: string;

  constructor(code: string, message: string) {
    super(message);
    this.code = code;
  }
}

/** The answer to a question to a WebAssembly module; throws a `CapsuleError` where the module refuses. */
export function asked<A>(question: () => A): A {
  try {
    return question();
  } catch (error) {
    // The modules write a code into each refusal. Anything else is a fault, and stays what it is.
    if (error instanceof Error && "code" in error) throw new CapsuleError(String(error.code), error.message);
    throw error;
  }
}
