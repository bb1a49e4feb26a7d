//! Arguments, help and exit codes.

mod fixture;

use fixture::Folder;

#[test]
fn help_lists_commands_and_exit_codes_on_stdout() {
    let help = Folder::new().ruga("--help").exits(0);
    for word in [
        "bake",
        "simulate",
        "job",
        "plan",
        "check",
        "new",
        "Exit codes",
        "did not converge",
    ] {
        assert!(
            help.stdout.contains(word),
            "no `{word}` in:\n{}",
            help.stdout
        );
    }
    assert_eq!(help.stderr, "");
}

#[test]
fn help_of_a_command_is_grouped_by_heading() {
    let help = Folder::new().ruga("bake --help").exits(0).stdout;
    let place = |text: &str| {
        help.find(text)
            .unwrap_or_else(|| panic!("no `{text}` in:\n{help}"))
    };
    assert!(place("Input:") < place("--pose"));
    assert!(place("\nOutput:") < place("--resume"));
    assert!(place("\nSimulation:") < place("--quality"));
    assert!(place("Exit codes") > place("--threads"));
}

#[test]
fn wrong_arguments_cannot_run() {
    let folder = Folder::new();
    for line in [
        "bakee scene.toml",
        "bake scene.toml",
        "bake scene.toml -o out --quality best",
        "bake scene.toml -o out --threads 0",
        "bake scene.toml -o out --threads two",
        "bake scene.toml -o out --memory lots",
        "simulate scene.toml -o out --memory 0GB",
        "plan",
        "new there --template nose",
    ] {
        let run = folder.ruga(line).exits(2);
        assert!(run.stderr.contains("error"), "{line}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{line}");
    }
    assert!(!folder.path("out").exists());
}

#[test]
fn version_is_the_crates() {
    let run = Folder::new().ruga("--version").exits(0);
    assert_eq!(
        run.stdout.trim(),
        concat!("ruga ", env!("CARGO_PKG_VERSION"))
    );
}

#[test]
fn shells_and_readers_of_manuals_get_every_command() {
    let folder = Folder::new();
    let script = folder.ruga("completions bash").exits(0).stdout;
    folder.ruga("man pages").exits(0);
    for command in ["bake", "plan", "preview", "help"] {
        assert!(script.contains(&format!("ruga,{command}")), "{command}");
        let page = folder.read(&format!("pages/ruga-{command}.1"));
        let page = String::from_utf8(page).expect("text");
        assert!(page.contains(&format!("ruga {command}")), "{page}");
    }
    let pages = folder.files("pages");
    assert_eq!(pages.len(), 12, "{pages:?}");
    folder
        .ruga("completions tcsh")
        .exits(2)
        .says(&["tcsh", "bash"]);
}

#[test]
fn a_quiet_run_tells_results_alone_and_others_how_long_it_will_take() {
    let folder = Folder::new();
    folder.ruga("new arm").exits(0);
    folder.change("arm/scene.toml", "[bake]\nsize = 1024", "[bake]\nsize = 64");
    let bake = "bake arm/scene.toml --quality draft --threads 1 --pose twist --pose pinch";
    let loud = folder.ruga(&format!("{bake} -o loud")).exits(0);
    let quiet = folder.ruga(&format!("{bake} -o quiet --quiet")).exits(0);
    for words in ["pose `twist` (1 of 2) started", "; about ", " left\n"] {
        assert!(loud.stderr.contains(words), "{}", loud.stderr);
    }
    // Nothing is left after the last.
    assert_eq!(
        loud.stderr.matches("; about ").count(),
        1,
        "{}",
        loud.stderr
    );
    assert!(!quiet.stderr.contains("pose `"), "{}", quiet.stderr);
    let table = |stdout: &str| stdout.lines().filter(|line| line.contains("yes")).count();
    assert_eq!(table(&quiet.stdout), table(&loud.stdout));
    assert!(table(&quiet.stdout) > 0, "{}", quiet.stdout);
}
