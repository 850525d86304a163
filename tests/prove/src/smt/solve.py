"""Answers an SMT-LIB file with a solver's Python package: solve.py NAME FILE SECONDS."""

import sys


def bitwuzla(path, seconds):
    from bitwuzla import Bitwuzla, Options, Option, Parser, Result, TermManager

    terms = TermManager()
    options = Options()
    options.set(Option.PRODUCE_MODELS, True)
    options.set(Option.TIME_LIMIT_PER, int(seconds * 1000))
    parser = Parser(terms, options)
    parser.parse(path, True, True)
    solver = parser.bitwuzla()
    answer = solver.check_sat()
    print({Result.SAT: "sat", Result.UNSAT: "unsat"}.get(answer, "unknown"))
    if answer == Result.SAT:
        for const in parser.get_declared_funs():
            print(const, solver.get_value(const))


def cvc5(path, seconds):
    import cvc5 as module

    solver = module.Solver()
    solver.setOption("produce-models", "true")
    solver.setOption("tlimit-per", str(int(seconds * 1000)))
    parser = module.InputParser(solver)
    parser.setFileInput(module.InputLanguage.SMT_LIB_2_6, path)
    symbols = parser.getSymbolManager()
    while True:
        command = parser.nextCommand()
        if command.isNull():
            break
        command.invoke(solver, symbols)
    answer = solver.checkSat()
    print("sat" if answer.isSat() else "unsat" if answer.isUnsat() else "unknown")
    if answer.isSat():
        for const in symbols.getDeclaredTerms():
            print(const, solver.getValue(const))


if __name__ == "__main__":
    {"bitwuzla": bitwuzla, "cvc5": cvc5}[sys.argv[1]](sys.argv[2], float(sys.argv[3]))
