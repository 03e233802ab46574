use capsule_core::Model;
use capsule_database::Database;
use capsule_offline::{Settings, build};
fn main() {
    let file = std::fs::read("models/capsule.crom").unwrap();
    let created_unix_s = Model::open(&file).unwrap().created_unix_s();
    let database = Database::open(std::path::Path::new("models/database")).unwrap();
    let settings = Settings {
        created_unix_s,
        ..Settings::default()
    };
    let (bytes, _) = build(&database, &settings, &|name, done, of| {
        if done % 100 == 0 {
            eprintln!("{name} {done}/{of}")
        }
    })
    .unwrap();
    std::fs::write("/tmp/rebuilt.crom", &bytes).unwrap();
    println!("{}", if bytes == file { "byte-identical" } else { "DIFFERENT" });
}
