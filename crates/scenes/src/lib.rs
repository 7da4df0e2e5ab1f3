//! Built-in scenes as code, and importers of scene files.
