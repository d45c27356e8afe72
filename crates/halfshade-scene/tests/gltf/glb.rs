//! Binary glTF files for tests.

/// A GLB file of a document and one buffer.
pub(crate) fn glb(json: &str, data: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF".to_vec();
    for number in [2, 12 + 8 + json.len() + 8 + data.len(), json.len()] {
        bytes.extend((number as u32).to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(&json);
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(data);
    bytes
}

/// Accessors and their data, one view each.
#[derive(Default)]
pub(crate) struct Builder {
    data: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Builder {
    /// A view of these bytes.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#, self.data.len(), bytes.len()));
        self.data.extend(bytes);
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    /// An accessor, as JSON.
    pub(crate) fn accessor(&mut self, json: String) -> usize {
        self.accessors.push(json);
        self.accessors.len() - 1
    }

    /// An accessor of `kind`, whose components are `component` in glTF's numbering; `more` goes into its JSON.
    pub(crate) fn list(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8], more: &str) -> usize {
        let view = self.view(bytes);
        let json =
            format!(r#"{{"bufferView":{view},"componentType":{component},"count":{count},"type":"{kind}"{more}}}"#);
        self.accessor(json)
    }

    /// An accessor of floats.
    pub(crate) fn floats(&mut self, kind: &str, list: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = list.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.list(kind, 5126, list.len() / width, &bytes, "")
    }

    /// An accessor of 16-bit indices.
    pub(crate) fn indices(&mut self, list: &[u16]) -> usize {
        let bytes: Vec<u8> = list.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.list("SCALAR", 5123, list.len(), &bytes, "")
    }

    /// The document of these parts and `rest`, the inside of its JSON object, as a GLB.
    pub(crate) fn glb(&self, rest: &str) -> Vec<u8> {
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}}}],{rest}}}"#,
            self.accessors.join(","),
            self.views.join(","),
            self.data.len()
        );
        glb(&json, &self.data)
    }
}
