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
